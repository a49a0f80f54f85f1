"""Flags with which the kernels of truth plants are compiled: IEEE division instead of exceptions."""

from functools import partial
from typing import cast

from sher3_common.compiled import Compiler
from sher3_common.compiled import compiled as _compiled

compiled = cast(Compiler, partial(_compiled, error_model="numpy", no_cfunc_wrapper=True))
"""Compile a kernel that Python calls."""

compiled_inner = cast(Compiler, partial(compiled, no_cpython_wrapper=True))
"""Compile a kernel that only other kernels call: without an entry from Python it compiles faster."""
