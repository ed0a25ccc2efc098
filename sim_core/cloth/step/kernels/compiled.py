"""Compilation of loops over arrays that never overlap, so that the compiler may use the vector unit.

LLVM has to assume that a written array may be one of those read, and guards a loop only while there are few of them.
`distinct` promises that no two array arguments of the function share memory. It is for functions whose arguments
hold to that; nothing checks it. Arithmetic is not re-ordered, and but for
`distinct_contracted` not contracted: equal input gives equal bits, for the arithmetic alone on any x86-64 (what calls
BLAS, sines or exponentials rounds as these do there).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit
from numba.core.compiler import Compiler


class _Distinct(Compiler):
    """Numba's own compiler with `noalias` on every array argument."""

    def __init__(
        self,
        typingctx: Any,
        targetctx: Any,
        library: Any,
        args: Any,
        return_type: Any,
        flags: Any,
        local: Any,
    ) -> None:
        flags = flags.copy()
        flags.noalias = True
        super().__init__(typingctx, targetctx, library, args, return_type, flags, local)


def distinct(function: Callable[..., Any]) -> Any:
    """`njit` with a cache for a function none of whose array arguments overlap."""
    return njit(cache=True, error_model="numpy", pipeline_class=_Distinct)(function)


def distinct_contracted(function: Callable[..., Any]) -> Any:
    """`distinct` where a product and a sum may become one instruction: for single precision, which promises less."""
    made = njit(cache=True, error_model="numpy", pipeline_class=_Distinct, fastmath={"contract"})
    return made(function)
