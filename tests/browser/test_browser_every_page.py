"""No page is left out of axe's tests: what the hall answers with is compared with what they open."""

import pytest
from plain_hall import write_plain_hall
from starlette.routing import compile_path
from test_browser_collection import COLLECTION
from test_browser_me import INSIDE, OUTSIDE
from test_browser_office import ANSWERS, OFFICE, PROGRAMME
from test_browser_reading import ASKING, PAGES

from hall_app.content import load
from hall_app.house import House
from hall_app.house.people import People
from hall_app.web import create_app
from hall_app.web.platform.counter import LEAD
from hall_app.web.platform.office import access
from survey import mount

# The hall itself and its catalogue are opened by modules of their own: test_browser_heard, test_browser_catalogue.
TESTED = ("/", "/catalogue", *PAGES, *ASKING, *OUTSIDE, *INSIDE, *PROGRAMME, *OFFICE, *COLLECTION)
# Addresses that answer with something else than a page.
NO_PAGE = (
    *("/api/", "/static/", "/viser/", "/scene/", "/media/", "/thumbnails/", "/iiif/", "/collection/", "/oai"),
    *("/survey-static/", "/grid.bin", "/research/"),
    *("/activities.ics", "/activities/{key}.ics", "/visit/{key}.ics"),
    *(f"/office/collection/{{key}}/{part}" for part in ("file", "picture", "shape")),
    *("/office/questionnaires/{key}/export", "/office/backups/{key}/file"),
)


@pytest.fixture
def hall(tmp_path, monkeypatch):
    """(the application, the deeds of the office that answer with a page of their own)."""
    content, shown, put = write_plain_hall(tmp_path / "content"), [], access.Access.deed
    house, people = House(load(content), tmp_path / "data"), People(tmp_path / "data")

    def noted(self, deed) -> None:
        if deed.shows is not None:
            shown.append(deed.path)
        put(self, deed)

    monkeypatch.setattr(access.Access, "deed", noted)
    app = create_app(house, people=people)
    mounted = mount(app, content=content, data=tmp_path / "data", problems=[])
    yield app, shown
    mounted.close()
    people.close()
    house.close()


def routes(router, above: str = ""):
    """Paths of all that answers GET by itself, those of included routers as well, as they are looked through."""
    for route in router.routes:
        if inside := getattr(route, "original_router", None):
            yield from routes(inside, above + route.include_context.prefix)
        elif "GET" in (getattr(route, "methods", None) or ()) and route.name != LEAD:
            yield above + route.path


def test_every_page_is_opened_by_a_test(hall):
    app, shown = hall
    known, opened = list(routes(app)), set()
    for path in TESTED:
        plain = path.partition("?")[0].replace("{", "").replace("}", "")
        opened |= {next((one for one in known if compile_path(one)[0].match(plain)), None)}
    left = set(known) - opened
    assert {path for path in left if not path.startswith(NO_PAGE)} == set()
    assert {path for path in opened - {None} if path.startswith(NO_PAGE)} == set()
    assert sorted(shown) == sorted(ANSWERS)
