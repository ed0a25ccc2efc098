"""A hall for the office's pages, apart from the one that others look at."""

import pytest
from plain_hall import EXHIBIT, write_plain_hall
from running_hall import running_hall


@pytest.fixture(scope="session")
def office_hall(tmp_path_factory):
    """One of its own: what is published here is seen by nobody else's test. It has a box and a crate."""
    work = tmp_path_factory.mktemp("office")
    content = write_plain_hall(work / "content")
    box, crate = content / "exhibits" / "box", content / "exhibits" / "crate"
    crate.mkdir()
    for file in box.iterdir():
        (crate / file.name).write_bytes(file.read_bytes())
    told = EXHIBIT.replace("x = 2.5, z = 3.0", "x = -6.0, z = 4.5").replace("Plain box", "Crate")
    (crate / "exhibit.toml").write_text(told.replace("方匣", "板箱"), "utf-8")
    with running_hall(content, work) as running:
        yield running
