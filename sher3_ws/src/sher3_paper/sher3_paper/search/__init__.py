"""Search for the best design of the delta: conditioning and torsional compliance under the constraints of the paper."""
