"""Work spread over threads, with results that do not depend on how many there are.

NumPy computes without holding Python's lock, so threads use several cores. Work is divided the
same way whatever the number of threads, and results come back in the order of the work.

OpenBLAS has threads of its own. They wait for each other within every product, which is slow where
other programs use the cores, and two callers wait for one another. Products of at most
:data:`LARGEST_PRODUCT` it computes in the calling thread; work for several threads is cut to that.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")

LARGEST_PRODUCT = 1 << 18
"""Multiply-adds of a matrix product up to which OpenBLAS leaves its threads asleep."""
_MOST_THREADS = 8
"""More threads wait for Python's lock longer than they compute."""
_VARIABLE = "OMP_NUM_THREADS"


class _Local(threading.local):
    """What the calling thread has: threads at work for it, or whether it is one of them."""

    pool: ThreadPoolExecutor | None = None
    busy: bool = False


_local = _Local()


def thread_count() -> int:
    """Return how many threads to use: ``OMP_NUM_THREADS``, else the cores at hand, at most 8."""
    wanted = os.environ.get(_VARIABLE, "").partition(",")[0].strip()
    if wanted.isdecimal() and int(wanted) > 0:
        return min(int(wanted), _MOST_THREADS)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return min(cores or 1, _MOST_THREADS)


def spread(function: Callable[[Item], Outcome], items: Sequence[Item]) -> list[Outcome]:
    """Return ``function(item)`` of every item in their order, computed by several threads.

    Called from within such work, it uses the calling thread alone.

    Parameters
    ----------
    function
        A pure function; it must not depend on thread-local state such as ``np.errstate`` outside.
    items
        Its arguments, best half a millisecond of work each, or more.

    Raises
    ------
    Exception
        The first that ``function`` raised; work not yet begun is left undone.
    """
    if len(items) < 2:
        return [function(item) for item in items]
    with threads_kept():
        pool = _local.pool
        if pool is None:
            return [function(item) for item in items]
        return list(pool.map(function, items))


@contextmanager
def threads_kept() -> Generator[None]:
    """Keep the threads of :func:`spread` from one call to the next within the block.

    They end with the block, so that nothing stays behind in a process that forks.
    """
    if _local.pool is not None or _local.busy or thread_count() < 2:
        yield
        return
    _local.pool = ThreadPoolExecutor(thread_count(), initializer=_mark_busy)
    try:
        yield
    finally:
        pool, _local.pool = _local.pool, None
        pool.shutdown(cancel_futures=True)


def _mark_busy() -> None:
    _local.busy = True
