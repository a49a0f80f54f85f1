"""Compiled functions without numba's look-up of the argument types, which in a control loop costs more than the work.

A call of a compiled function first finds out the type of every argument, down to the last member of nested tuples:
11 us of the 15 us of a tick of the admittance law. Where the types are always the same they are looked up once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def direct(function: Any, *example: Any) -> Callable[..., Any]:
    """Return the machine code of a compiled function for arguments of the types of `example`, called by position.

    The caller answers for the types: the dtype and shape of arrays and the length of tuples must be those of the
    example (numba raises ValueError or TypeError for another length or a number that is none). A function that is not
    compiled, as when numba is switched off, is returned as it is.
    """
    if not hasattr(function, "overloads"):
        return function
    types = tuple(numba.typeof(value) for value in example)
    function.compile(types)
    return function.overloads[types].entry_point
