"""A chain of joints as a machine of the diagnosis: what axes by themselves and the joints of an arm share."""
