"""The frame loop asks for no memory: lists of pairs are made once, and grow only when they are full."""

import numpy as np
import pytest
from numba.core.registry import cpu_target
from numba.core.runtime import _nrt_python  # pyright: ignore[reportAttributeAccessIssue]
from numba.core.runtime.nrt import rtsys

from sim_core.cloth import Capsule, Contact, Material, Sheet
from sim_core.cloth.scenes import equilateral_sheet
from sim_core.cloth.step import Engine, Frame, State, Stride

CONTACT = Contact(0.003, 0.001, thickness=0.004, skin=0.002, untangle=5)
FALLING = Frame(gravity=np.array([0.0, -9.81, 0.0]), damping=4.0, friction=0.3, speed_limit=2.0)


def crumpled() -> tuple[Engine, State]:
    """A sheet in narrow folds over a bar, falling: its pairs change all the time."""
    rest, faces = equilateral_sheet(0.3, 0.3, 0.015)
    sheet = Sheet.of(rest, faces, Material(0.05, 50.0, 0.3, 1e-5, 0.3, 1.0))
    engine = Engine(sheet, collider=Capsule((-1.0, 0, 0), (1.0, 0, 0), 0.02), contact=CONTACT)
    u, w = rest[:, 0] / 0.3, rest[:, 1] / 0.3
    x = np.column_stack([0.09 * u, 0.03 + 0.02 * np.sin(40 * u), 0.2 * (w - 0.5)])
    return engine, State(engine.inward(x), np.zeros((3, len(x))))


def allocated() -> int:
    """Blocks of memory that compiled code has asked for so far."""
    return int(rtsys.get_allocation_stats().mi_alloc)


@pytest.fixture
def counted():
    """Compiled code counts what it asks for."""
    rtsys.initialize(cpu_target.target_context)
    _nrt_python.memsys_enable_stats()
    yield
    _nrt_python.memsys_disable_stats()


def places(engine: Engine) -> set[int]:
    """Where the lists of near pairs lie in memory."""
    return {array.ctypes.data for half in (engine.near.now, engine.near.spare) for array in half}


def test_the_compiled_loop_allocates_nothing_once_the_lists_are_long_enough(counted) -> None:
    """Handing arrays over costs a block each; four times the steps, dozens of searches among them, cost no more."""
    engine, state = crumpled()
    engine.advance(FALLING, state, Stride(400, 0.0))
    lists, cost = places(engine), []
    for steps in (400, 1600):
        begin, before = state.copy(), allocated()
        engine.advance(FALLING, state, Stride(steps, 1e-4))
        cost.append(allocated() - before)
    assert np.linalg.norm(state.x - begin.x, axis=0).max() > 5 * CONTACT.skin
    assert cost[1] - cost[0] < 5
    assert places(engine) == lists


def test_full_lists_grow_and_keep_the_result() -> None:
    ends = []
    for short in (False, True):
        engine, state = crumpled()
        if short:
            short_lists = engine.near.now._replace(
                points=np.zeros((4, 3), np.int32), crossings=np.zeros((4, 3), np.int32)
            )
            engine.near = engine.near._replace(now=short_lists)
        engine.advance(FALLING, state, Stride(400, 0.0))
        ends.append(state.x)
        assert min(len(engine.near.now.points), len(engine.near.now.crossings)) > 4
    assert ends[0].tobytes() == ends[1].tobytes()


@pytest.mark.parametrize("broken", [np.nan, np.inf, 1e300])
def test_a_search_through_what_blew_up_finds_nothing_and_returns(broken: float) -> None:
    from sim_core.cloth.contact import Mesh, Search, begin_pairs, near_pairs_of, patches_of, shapes_of

    rest, faces = equilateral_sheet(0.1, 0.1, 0.02)
    faces = faces.astype(np.int32)
    edges = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    x = np.column_stack([rest, np.zeros(len(rest))])
    x[3] = broken
    same = np.arange(len(x), dtype=np.int32)
    mesh = Mesh(np.ones(len(x)), rest, edges, faces, np.ones(len(edges)), same)
    patches = patches_of(edges, faces, same, rest[faces])
    lists = near_pairs_of(len(x), len(edges), len(patches.bay))
    found = begin_pairs(x, mesh, patches, shapes_of(patches), Search(0.01, 0.01, 0.0, 0.02), lists)
    assert not found.now.count[1:].any()
