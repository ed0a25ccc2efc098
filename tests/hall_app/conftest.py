"""Coarse bakes, made once for all tests of a run that only look at them."""

import pytest
from coarse_bake import LAYERED, build, coarse, last_line


@pytest.fixture(scope="session")
def coarse_folder(tmp_path_factory):
    """The content folder both are baked in."""
    return coarse(tmp_path_factory.mktemp("coarse"))


@pytest.fixture(scope="session")
def coarse_scarf(coarse_folder):
    """(content folder, what the command said of it) with the scarf on its stand baked."""
    return coarse_folder, last_line(build(coarse_folder))


@pytest.fixture(scope="session")
def coarse_layers(coarse_folder):
    """The same with the scarf over a robe baked."""
    return coarse_folder, last_line(build(coarse_folder, exhibit=LAYERED))
