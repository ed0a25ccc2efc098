"""The collection in the office: the files that curators edit by hand, as drafts, by forms or whole.

desk: what all pages work with; listing: the exhibits; exhibit: one, its forms and texts; keys, words: forms made from
models; files: what is brought; place: the plan; views: the preview; history: published, undone; bakes: the queue.
"""

from hall_app.house.drafts import TEXT_FILES, USES
from hall_app.web.platform.counter import Counter, Takes
from hall_app.web.platform.office.collection.bakes import Bakes
from hall_app.web.platform.office.collection.desk import Desk
from hall_app.web.platform.office.collection.exhibit import Exhibits
from hall_app.web.platform.office.collection.files import MOST_FILES, Uploads
from hall_app.web.platform.office.collection.history import LISTED, History
from hall_app.web.platform.office.collection.keys import keys_of
from hall_app.web.platform.office.collection.listing import Listing
from hall_app.web.platform.office.collection.place import Places
from hall_app.web.platform.office.collection.views import Previews
from hall_app.web.platform.office.collection.words import WORDS
from hall_app.web.platform.office.deeds import Deed, Reading

__all__ = ["WORDS", "collection_rooms", "keys_of"]

_TEXT = Takes(largest=700_000)  # [bytes]: three for a Chinese letter, nine in a form
_FILES = Takes(largest=260_000_000, files=MOST_FILES)
_ONE = "collection/{key}"
_KEYS = "keys of exhibit.toml as hall check names them: title.zh, record.material.en, body.radius, media[1].alt.zh …"
_TAG = "of the file as it was read; 409 where it is another by now"


def collection_rooms(counter: Counter) -> tuple[tuple[Reading, ...], tuple[Deed, ...]]:
    """What can be read and done of the collection."""
    desk = Desk(counter)
    listing, exhibits, uploads, places = Listing(desk), Exhibits(desk), Uploads(desk), Places(desk)
    previews, history, bakes = Previews(desk), History(desk), Bakes(desk)
    readings = (
        Reading("collection", "draft", listing.all, listing.page),
        Reading(_ONE, "draft", exhibits.one, exhibits.page),
        Reading(
            f"{_ONE}/text", "draft", exhibits.text, exhibits.text_page, {"file": " or ".join(TEXT_FILES)}
        ),
        Reading(
            f"{_ONE}/file", "preview", uploads.facts, uploads.shown, {"name": "of a file of the exhibit"}
        ),
        Reading(
            f"{_ONE}/picture", "preview", uploads.facts, uploads.picture, {"name": "of a GLB of the exhibit"}
        ),
        Reading(
            f"{_ONE}/shape",
            "preview",
            uploads.facts,
            uploads.turned,
            {"name": "of a GLB or scan of the exhibit; its page is a file of triangles"},
        ),
        Reading(f"{_ONE}/preview", "preview", previews.told, previews.page),
        Reading(f"{_ONE}/place", "place", places.where, places.page),
        Reading(f"{_ONE}/history", "draft", history.all, history.page, {"page": f"from 1, of {LISTED} each"}),
        Reading("bakes", "bake", bakes.all, bakes.page),
    )
    titles = {"id": "name of its folder", "title.zh": "Chinese", "title.en": "English"}
    text = {"file": " or ".join(TEXT_FILES), "text": "the whole file", "tag": _TAG}
    place = {
        f"place.{name}": f"place.{name} of exhibit.toml" for name in ("x", "z", "facing", "on", "y", "lamp")
    }
    upload = {"use": " or ".join(USES), "alt.zh": "what it shows", "alt.en": "what it shows"}
    seen = {"seen": "the draft's mark as it was read; 409 where it is another by now"}
    deeds = (
        Deed("collection", "draft", listing.make, "collection/{id}", listing.page, fields=titles),
        Deed(
            f"{_ONE}/fields",
            "draft",
            exhibits.save_fields,
            _ONE,
            exhibits.page,
            takes=_TEXT,
            fields={"tag": _TAG, "caption.zh": _KEYS, "licence": _KEYS},
        ),  # fmt: skip
        Deed(f"{_ONE}/text", "draft", exhibits.save_text, _ONE, exhibits.text_page, takes=_TEXT, fields=text),
        Deed(f"{_ONE}/upload", "draft", uploads.bring, _ONE, uploads.page, takes=_FILES, fields=upload),
        Deed(f"{_ONE}/remove", "draft", uploads.remove, _ONE, exhibits.page, fields={"file": "its name"}),
        Deed(f"{_ONE}/drop", "draft", exhibits.drop, "collection", exhibits.page, fields=seen),
        Deed(
            f"{_ONE}/place", "place", places.put, f"{_ONE}/place", places.page, fields=place | {"tag": _TAG}
        ),
        Deed(f"{_ONE}/publish", "publish", history.publish, _ONE, exhibits.page, fields=seen),
        Deed(
            f"{_ONE}/undo",
            "undo",
            history.undo,
            f"{_ONE}/history",
            history.page,
            fields={"revision": "its id"},
        ),
        Deed("bakes/{key}/stop", "bake", bakes.stop, "bakes", bakes.page),
        Deed("bakes/{key}/again", "bake", bakes.again, "bakes", bakes.page),
    )
    return readings, deeds
