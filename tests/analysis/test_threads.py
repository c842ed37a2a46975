"""Work spread over threads: the same results as in one, in the same order."""

from __future__ import annotations

import threading

import pytest

from surmount.analysis.threads import spread, thread_count, threads_kept

HANGING_S = 1800.0
"""Whoever waits longer waits in vain: far more than the slowest machine takes."""


@pytest.fixture(params=["1", "2", "5"])
def threads(request, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", request.param)
    return int(request.param)


def test_results_come_in_the_order_of_the_work(threads):
    slow_first = threading.Event()

    def work(item):
        if item == 0 and threads > 1:
            assert slow_first.wait(HANGING_S)  # ends after item 1, and still comes first
        slow_first.set()
        return item * item

    assert spread(work, range(20)) == [item * item for item in range(20)]


def test_several_threads_work_at_once(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    together = threading.Barrier(2, timeout=HANGING_S)
    spread(lambda _: together.wait(), range(2))  # a single thread would wait in vain


def test_work_within_work_stays_in_its_thread(threads):
    def work(item):
        inner = spread(lambda _: threading.get_ident(), range(4))
        return item, set(inner) == {threading.get_ident()}

    assert spread(work, range(8)) == [(item, True) for item in range(8)]


def test_no_thread_outlives_the_call_or_the_block(threads):
    before = threading.active_count()
    spread(str, range(10))
    assert threading.active_count() == before
    with threads_kept():
        first = set(spread(lambda _: threading.get_ident(), range(50)))
        again = set(spread(lambda _: threading.get_ident(), range(50)))
        assert len(first | again) <= threads
    assert threading.active_count() == before


def test_an_error_in_the_work_reaches_the_caller(threads):
    def work(item):
        if item == 3:
            raise ValueError("the third")
        return item

    with pytest.raises(ValueError, match="the third"):
        spread(work, range(100))
    assert spread(work, range(3)) == [0, 1, 2]


@pytest.mark.parametrize(
    ("value", "wanted"), [("1", 1), ("2", 2), (" 3,2", 3), ("100", 8), ("0", None), ("many", None)]
)
def test_the_number_of_threads_is_that_of_openmp(monkeypatch, value, wanted):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    otherwise = thread_count()
    assert 1 <= otherwise <= 8
    monkeypatch.setenv("OMP_NUM_THREADS", value)
    assert thread_count() == (wanted or otherwise)
