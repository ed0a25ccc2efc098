"""What is compiled is counted apart, and told when it is long."""

import time

from numba import njit

from sim_core.mesh import panel_mesh
from sim_core.metrics import compile_clock
from sim_core.metrics import compile_time as machine_code

SQUARE = [[0.0, 0], [1, 0], [1, 1], [0, 1]]


def kernel():
    """A kernel that is compiled at its first call, never cached."""

    @njit
    def added(x):
        return x + 1

    return added


def test_the_clock_counts_compiling_and_nothing_else():
    added = kernel()
    with compile_clock() as outer:
        time.sleep(0.02)
        assert outer.seconds == 0
        with compile_clock() as inner:
            begin = time.perf_counter()
            assert added(1) == 2
            spent = time.perf_counter() - begin
        assert 0 < inner.seconds <= spent
        before = outer.seconds
        assert before > 0
        assert added(2) == 3
        assert outer.seconds == before
    assert kernel()(1) == 2
    assert outer.seconds == before  # it has stopped


def test_long_compiling_is_told_once(monkeypatch):
    told = []
    monkeypatch.setattr(machine_code, "LONG", 0.0)
    with compile_clock(lambda: told.append("making")):
        kernel()(1)
        kernel()(1)
    assert told == ["making"]
    monkeypatch.setattr(machine_code, "LONG", 1e9)
    with compile_clock(lambda: told.append("again")):
        kernel()(1)
    assert told == ["making"]


def test_a_mesh_tells_compiling_apart_from_its_own_time(monkeypatch):
    """A kernel that is compiled while a panel is meshed: its seconds are in `compile_seconds` alone."""
    from sim_core.mesh import panel

    original, spent = panel.check_edge, []

    def slow(*args):
        begin = time.perf_counter()
        kernel()(1)
        spent.append(time.perf_counter() - begin)
        return original(*args)

    panel_mesh(SQUARE, edge=0.2)
    monkeypatch.setattr(panel, "check_edge", slow)
    begin = time.perf_counter()
    report = panel_mesh(SQUARE, edge=0.2).report
    whole = time.perf_counter() - begin
    assert 0 < report.compile_seconds <= spent[0]
    assert 0 < report.seconds <= whole - report.compile_seconds
