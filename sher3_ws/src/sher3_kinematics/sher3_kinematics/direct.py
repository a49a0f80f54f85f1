"""Calls of compiled functions without numba's look-up of the argument types.

A call of a compiled function first finds out the type of every argument, down to the last member of nested tuples.
That takes 11 us of the 15 us of one tick of the admittance law. Where the types never change, one look-up is enough.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def direct(function: Any, *example: Any) -> Callable[..., Any]:
    """Return the machine code of a compiled function for arguments of the types of `example`, called by position.

    The caller vouches for the types: dtype and shape of arrays and length of tuples must be those of the example.

    Returns:
        The machine code; the function itself when it is not compiled, as with numba switched off.

    Raises:
        ValueError, TypeError: In a call, for a tuple of another length or a value that is not a number.
    """
    if not hasattr(function, "overloads"):
        return function
    types = tuple(numba.typeof(value) for value in example)
    function.compile(types)
    return function.overloads[types].entry_point
