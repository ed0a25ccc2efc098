"""The data folder: who may read it when we made it, and when it was there."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from hall_app.content import make_data_folder


@pytest.fixture(params=[0o000, 0o022, 0o777])
def umask(request):
    before = os.umask(request.param)
    yield request.param
    os.umask(before)


def rights(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_what_we_make_is_closed_whatever_the_umask(tmp_path, umask):
    make_data_folder(tmp_path / "data")
    assert rights(tmp_path / "data") == 0o700


@pytest.mark.parametrize("mode", [0o755, 0o750, 0o777])
def test_what_was_there_keeps_its_rights(tmp_path, mode):
    folder = tmp_path / "data"
    folder.mkdir()
    folder.chmod(mode)
    make_data_folder(folder)
    assert rights(folder) == mode


def test_what_cannot_be_made_is_told_with_its_option(tmp_path):
    (tmp_path / "data").write_text("a file", "utf-8")
    with pytest.raises(OSError, match="--data .*data: File exists – choose a folder"):
        make_data_folder(tmp_path / "data")
