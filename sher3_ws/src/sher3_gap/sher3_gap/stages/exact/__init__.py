"""Transport and controller: their nominal output is computed to rounding, so that an error is no estimate."""
