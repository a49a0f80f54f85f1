"""Where compiled kernels are kept, and under which name: part of `compiled`."""
