"""The front page says what was measured last: a bake or a bench whose figures were not carried over fails here."""

import sys
from importlib import import_module
from pathlib import Path

import pytest

pytestmark = pytest.mark.door
ROOT = Path(__file__).parents[1]


@pytest.fixture
def front(monkeypatch):
    """The program that writes the front page's table; it imports its neighbours by their bare names."""
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "bench"))
    yield import_module("readme_figures")
    for name in ("readme_figures", "mesh_figures", "research_figures", "readme_learn", "signature"):
        sys.modules.pop(name, None)


def test_every_figure_of_the_front_page_is_the_last_one_measured(front) -> None:
    rows = front.rows()
    text = (ROOT / "README.md").read_text("utf-8")
    stale = [row for row in rows if f"| {' | '.join(row)} |" not in text]
    assert not stale, f"python tests/bench/readme_figures.py: {stale}"
    assert len(rows) > 40
