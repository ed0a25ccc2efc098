"""Coarse bakes, made once for all tests of a run that only look at them; passwords hashed quickly."""

import argon2
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


class Quick(argon2.PasswordHasher):
    def __init__(self, **_: int) -> None:
        super().__init__(time_cost=1, memory_cost=8, parallelism=1)


@pytest.fixture(autouse=True, scope="session")
def quick_hashes():
    """Hashes of passwords cost next to nothing in this process; `hall admin` and `hall serve` are others."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(argon2, "PasswordHasher", Quick)
        yield


@pytest.fixture(scope="session")
def counter(tmp_path_factory, quick_hashes):
    """The platform's pages and API alone, open."""
    from open_counter import open_counter

    with open_counter(tmp_path_factory.mktemp("counter")) as found:
        yield found
