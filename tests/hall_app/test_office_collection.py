"""The collection in the office: drafts by forms and whole texts, uploads, publication, conflict, history, undo."""

from __future__ import annotations

import http.client
import io
import json
import shutil
import tomllib
import uuid
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from urllib.parse import urlsplit

import pytest
from content_house import EXHIBIT, add_exhibit
from office_clerk import Clerk, clerk
from PIL import Image

from hall_app.check import check
from hall_app.content import load
from hall_app.house.drafts import Drafts, Examination, Publication, Shelf, publication
from hall_app.house.people import People, PeopleError, Role
from hall_app.house.safekeeping import ArchiveError, Holdings, back_up, restore

TOML = "exhibit.toml"


@pytest.fixture
def curator(counter) -> Clerk:
    return clerk(counter, counter.people, Role.CURATOR)


@pytest.fixture
def chest(counter):
    """An exhibit of its own, with a comment, that goes afterwards; its folder."""
    key = f"c{uuid.uuid4().hex[:10]}"
    place = EXHIBIT.replace("x = 0.0", "x = 0.0 # by hand").replace("z = -1.0", "z = 2.0")
    home = add_exhibit(counter.content, key, "# The chest. 箱\n" + place)
    yield home
    shutil.rmtree(home, ignore_errors=True)


def png(size=(40, 30), colour="#7a4b2e", kind="PNG") -> bytes:
    data = io.BytesIO()
    Image.new("RGB", size, colour).save(data, kind)
    return data.getvalue()


def bring_picture(one: Clerk, key: str) -> None:
    told = {"use": "picture", "alt.zh": "袍", "alt.en": "A robe"}
    answer = one.bring(key, [("Front view.png", png())], **told)
    assert answer.status == 200, answer.text


def tag(one: Clerk, key: str, name: str = TOML) -> str:
    return one.told(f"collection/{key}/text?file={name}")["tag"]


def publish(one: Clerk, key: str) -> None:
    one.told(f"collection/{key}/publish", {})


def test_a_form_changes_what_was_typed_and_not_a_byte_more(curator, chest):
    key, before = chest.name, (chest / TOML).read_text("utf-8")
    page = curator.get(f"/office/collection/{key}?lang=en")
    done = curator.send(
        page, "form-words", **{"title.en": 'A "red" chest', "caption.zh": "一句", "caption.en": "One"}
    )
    assert done.status == 200
    assert (chest / TOML).read_text("utf-8") == before, "a draft is not in the hall"
    publish(curator, key)
    after = (chest / TOML).read_text("utf-8")
    assert tomllib.loads(after)["title"]["en"] == 'A "red" chest'
    added = [line for line in after.splitlines() if line not in before.splitlines()]
    assert len(added) == 2
    assert "# by hand" in after
    assert load(chest.parents[1]).exhibit(key).file.caption.en == "One"


def test_every_section_of_the_form_is_saved_as_it_stands(curator, chest):
    """Saving what nobody changed changes nothing: no draft comes of it."""
    key = chest.name
    page = curator.get(f"/office/collection/{key}")
    for name in ("words", "shown", "record", "stands"):
        assert curator.send(page, f"form-{name}").status == 200
    for language in ("zh", "en"):
        assert curator.send(page, f"form-text-{language}").status == 200
    assert curator.told(f"collection/{key}")["draft"] is None


def test_texts_are_written_whole_and_read_back(curator, chest):
    key = chest.name
    page = curator.get(f"/office/collection/{key}?lang=en")
    curator.send(page, "form-text-en", text="# A chest\r\n\r\nOf *camphor* wood & more.")
    assert (
        curator.told(f"collection/{key}/text?file=text.en.md")["text"]
        == "# A chest\n\nOf *camphor* wood & more."
    )
    publish(curator, key)
    assert (chest / "text.en.md").read_bytes() == b"# A chest\n\nOf *camphor* wood & more."
    preview = curator.get(f"/office/collection/{key}/preview?lang=en").text
    assert "<em>camphor</em>" in preview
    assert "wood &amp; more" in preview


def test_what_two_change_at_once_is_told_with_both_versions(counter, curator, chest):
    key, other = chest.name, clerk(counter, counter.people, Role.EDITOR)
    mine = tag(curator, key, "text.en.md")
    other.told(f"collection/{key}/text", {"file": "text.en.md", "text": "theirs", "tag": mine})
    answer = curator.api(f"collection/{key}/text", {"file": "text.en.md", "text": "ours", "tag": mine})
    assert answer.status == 409
    told = json.loads(answer.body)
    assert (told["error"], told["now"], told["yours"]) == ("changed", "theirs", "ours")
    page = curator.send(
        f"/office/collection/{key}/text?file=text.en.md&lang=en", "form-text", text="ours", tag=mine
    )
    assert page.status == 409
    assert "\nours</textarea>" in page.text
    assert "theirs" in page.text
    # The page that shows both may write over it, knowingly.
    assert curator.send(page, "form-text").status == 200
    assert curator.told(f"collection/{key}/text?file=text.en.md")["text"] == "ours"


def test_a_file_changed_by_hand_beneath_a_draft_is_not_overwritten(curator, chest):
    key = chest.name
    curator.told(f"collection/{key}/fields", {"title.en": "Of the office"})
    by_hand = (chest / TOML).read_text("utf-8").replace("Chest", "By hand")
    (chest / TOML).write_text(by_hand, "utf-8")
    assert curator.told(f"collection/{key}")["stale"] == [TOML]
    for act, given in (("publish", {}), ("fields", {"title.en": "Again"})):
        assert curator.api(f"collection/{key}/{act}", given).status == 409
    assert (chest / TOML).read_text("utf-8") == by_hand
    both = curator.get(f"/office/collection/{key}/text?file={TOML}&lang=en")
    assert "By hand" in both.text
    assert "Of the office" in both.text
    merged = by_hand.replace("By hand", "Of both")
    curator.send(both, "form-text", text=merged)
    publish(curator, key)
    assert (chest / TOML).read_text("utf-8") == merged


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"title.en": ""}, "title"),
        ({"body.radius": "wide"}, "body.radius"),
        ({"body.radius": "-1"}, None),
        ({"place.x": "90"}, None),
        ({"thumbnail": "../../hall.toml"}, None),
        ({"models.hall": "media/nothing.glb"}, None),
    ],
)
def test_what_the_check_refuses_is_not_published(curator, chest, given, said):
    key, before = chest.name, (chest / TOML).read_bytes()
    answer = curator.api(f"collection/{key}/fields", given)
    if said:
        assert answer.status == 400
        assert said in answer.text
        return
    assert answer.status == 200
    told = curator.api(f"collection/{key}/publish", {})
    assert told.status == 400
    assert json.loads(told.body)["error"] == "content-check"
    assert (chest / TOML).read_bytes() == before
    assert curator.told(f"collection/{key}")["problems"], "the page names them before anybody publishes"


def test_what_is_no_toml_is_refused_at_once(curator, chest):
    answer = curator.api(f"collection/{chest.name}/text", {"file": TOML, "text": "title = "})
    assert answer.status == 400
    assert "exhibit.toml" in answer.text


def test_pictures_are_drawn_anew_named_and_shown(counter, curator, chest):
    key = chest.name
    jpeg = png(kind="JPEG") + b"<script>alert(1)</script>"
    told = curator.bring(
        key,
        [("../Röbe №1.PNG", png()), ("b.jpg", jpeg)],
        use="picture",
        **{"alt.zh": "袍", "alt.en": "A robe"},
    )
    assert told.status == 200, told.text
    names = list(json.loads(told.body)["files"])
    assert names == ["media/robe-no1.png", "media/b.jpg"]
    shown = curator.get(f"/office/collection/{key}/file?name={names[1]}")
    assert shown.headers["Content-Type"] == "image/jpeg"
    assert b"script" not in shown.body
    assert "sandbox" in shown.headers["Content-Security-Policy"]
    publish(curator, key)
    found = load(counter.content).exhibit(key).file.media[-2:]
    assert [one.file for one in found] == names
    assert found[0].alt.en == "A robe"
    assert not [one for one in check(counter.content) if key in one.file]
    curator.told(f"collection/{key}/remove", {"file": names[0]})
    publish(curator, key)
    assert not (chest / names[0]).exists()
    assert names[0] not in (chest / TOML).read_text("utf-8")


@pytest.mark.slow
def test_a_model_is_drawn_for_who_brought_it(counter, curator, chest):
    box = (chest / "media/chest.glb").read_bytes()
    assert curator.bring(chest.name, [("close.glb", box)], use="close").status == 200
    page = curator.get(f"/office/collection/{chest.name}/preview?lang=en").text
    assert f"/office/collection/{chest.name}/picture" in page
    drawn = curator.get(f"/office/collection/{chest.name}/picture?name=media/close.glb")
    assert drawn.headers["Content-Type"] == "image/jpeg"
    pixels = Image.open(io.BytesIO(drawn.body)).convert("L")
    low, high = pixels.crop((200, 250, 280, 350)).getextrema()
    assert pixels.size == (480, 600)
    assert high > low, "there is something in the middle of it"
    assert curator.ask("GET", f"/office/collection/{chest.name}/picture?name=media/front.jpg").status == 404


def test_drawn_models_are_not_kept_without_end(counter, curator, chest, monkeypatch):
    from hall_app.web.platform.office.collection import files

    monkeypatch.setattr(files, "MOST_DRAWN", 2)
    monkeypatch.setattr(files, "beside", lambda make, path, ending, within: path.read_bytes())
    for number in range(4):
        scan = f"v {number} 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n".encode()
        brought = json.loads(curator.bring(chest.name, [("s.obj", scan)], use="scan").body)
        (name,) = brought["files"]
        shown = curator.ask("GET", f"/office/collection/{chest.name}/picture?name={name}")
        assert shown.body == scan
    assert len(list((counter.data / "portraits").iterdir())) == 2


def test_history_tells_differences_and_undo_takes_them_back(curator, chest):
    key, before = chest.name, (chest / TOML).read_bytes()
    for title in ("First", "Second"):
        curator.told(f"collection/{key}/fields", {"title.en": title})
        publish(curator, key)
    second, first = curator.told(f"collection/{key}/history")
    page = curator.get(f"/office/collection/{key}/history?lang=en").text
    assert "Second" in page
    assert curator.api(f"collection/{key}/undo", {"revision": first["id"]}).status == 409
    for one in (second, first):
        curator.told(f"collection/{key}/undo", {"revision": one["id"]})
    assert (chest / TOML).read_bytes() == before
    assert [one["act"] for one in curator.told(f"collection/{key}/history")] == ["undo"] * 2 + ["publish"] * 2


def test_a_restored_house_goes_on_drafting_and_undoing(counter, curator, chest, tmp_path):
    key, before = chest.name, (chest / TOML).read_bytes()
    curator.told(f"collection/{key}/fields", {"title.en": "Published"})
    bring_picture(curator, key)
    publish(curator, key)
    curator.told(f"collection/{key}/fields", {"title.en": "In a draft"})
    file, data = tmp_path / "all.zip", tmp_path / "data"
    back_up(file, counter.house.holdings)
    house = Holdings(tmp_path / "content", data, data, data)
    restore(file, house)
    with pytest.raises(ArchiveError, match="an office has worked there already"):
        restore(file, replace(house, content=tmp_path / "second", accounts=tmp_path, answers=tmp_path))
    drafts = Drafts(house.content, data, Shelf(data / "shelf"))
    assert "In a draft" in drafts.text(key, TOML)
    drafts.drop(key)
    people = People(data)
    try:
        putting = Publication(drafts, Examination(house.content), people)
        (one,) = people.revisions.of(key)
        putting.undo("console", one.id)
        assert (house.content / "exhibits" / key / TOML).read_bytes() == before
        putting.undo("console", people.revisions.of(key)[0].id)
        assert b"Published" in (house.content / "exhibits" / key / TOML).read_bytes()

        inside = drafts.shelf.put(b"not of this exhibit")
        with people.revisions.adding("console", "publish", key, {"../../evil.txt": (inside, "")}):
            pass  # as a history would have it that somebody made up
        with pytest.raises(PeopleError) as refused:
            putting.undo("console", people.revisions.of(key)[0].id)
    finally:
        people.close()
    assert refused.value.key == "no-file"
    assert not (house.content / "evil.txt").exists()


@pytest.mark.parametrize("written", [1, 2])
def test_publishing_again_completes_what_was_killed(counter, curator, chest, monkeypatch, written):
    """Some files are in place and nothing is written down: it is, with what was there before, and can be undone."""
    key, before = chest.name, (chest / TOML).read_bytes()
    curator.told(f"collection/{key}/fields", {"title.en": "Published"})
    bring_picture(curator, key)
    drafts = Drafts(counter.content, counter.data, Shelf(counter.data / "shelf"))
    again = Publication(drafts, Examination(counter.content), counter.people)
    put, changed, done = publication.replace_file, drafts.of(key).files, []
    assert len(changed) == 2

    def killed(*given) -> None:
        put(*given)
        done.append(given)
        if len(done) == written:
            raise KeyboardInterrupt

    monkeypatch.setattr(publication, "replace_file", killed)
    with pytest.raises(KeyboardInterrupt):
        again.publish("console", key)
    monkeypatch.undo()
    assert counter.people.revisions.of(key) == ()
    again.tidy()
    again.publish("console", key)
    (revision,) = counter.people.revisions.of(key)
    assert {name: after for name, (_, after) in revision.files.items()} == changed
    again.undo("console", revision.id)
    assert (chest / TOML).read_bytes() == before


def test_a_new_exhibit_from_draft_to_hall_and_back(counter, curator):
    key = f"n{uuid.uuid4().hex[:10]}"
    page = curator.send(
        "/office/collection?lang=en", "form-exhibit", id=key, **{"title.zh": '"新"袍', "title.en": "New robe"}
    )
    assert "New robe" in page.text
    assert curator.api(f"collection/{key}/publish", {}).status == 400, "it has no model yet"
    box = (counter.content / "exhibits/chest/media/chest.glb").read_bytes()
    assert curator.bring(key, [("Robe.glb", box)], use="hall").status == 200
    curator.told(f"collection/{key}/place", {"place.x": "-3", "place.z": "3", "place.facing": "90"})
    assert curator.told(f"collection/{key}/preview")["whole"]
    publish(curator, key)
    found = load(counter.content).exhibit(key)
    assert (found.file.models.hall, found.file.place.facing) == ("media/robe.glb", 90.0)
    (one,) = curator.told(f"collection/{key}/history")
    curator.told(f"collection/{key}/undo", {"revision": one["id"]})
    assert not found.folder.exists()
    for name in ("hall", "../x", "Ab", "", "a" * 61, "chest"):
        answer = curator.api("collection", {"id": name, "title.zh": "一", "title.en": "one"})
        assert answer.status == (409 if name == "chest" else 400), name


def test_a_place_that_shuts_others_off_is_told_before_it_is_published(counter, curator, chest):
    key = chest.name
    wall = {"body.shape": "box", "body.radius": "", "body.size": "9.6 0.4", "place.x": "0", "place.z": "1.6"}
    curator.told(f"collection/{key}/fields", wall)
    answer = curator.api(f"collection/{key}/publish", {})
    assert answer.status == 400
    assert "cannot be reached on foot" in answer.text
    told = curator.told(f"collection/{key}/place")
    assert told["reached"] is False
    assert "cannot be reached" in curator.get(f"/office/collection/{key}/place?lang=en").text


def test_a_walk_that_came_to_nothing_says_so_and_is_begun_anew(counter, chest, monkeypatch):
    """The draft was saved again while it was looked at, say: its files are gone, and nobody has walked."""
    from hall_app.house.drafts import Examination, examination

    moved = (chest / TOML).read_bytes().replace(b"x = 0.0", b"x = 0.1")
    files = {f"exhibits/{chest.name}/{TOML}": moved}
    examined = Examination(counter.content)

    def gone(*given):
        raise FileNotFoundError("a file of the shelf")

    for name, act in (("likeness_of", gone), ("beside", lambda *given: None)):
        with monkeypatch.context() as broken:
            broken.setattr(examination, name, act)
            assert [one.file for one in examined.reach(files, wait=True) or ()] == ["plan.toml"]
    assert examined.reach(files, wait=True) == []


def test_what_changed_since_it_was_looked_at_is_not_published(counter, curator, chest):
    key, editor = chest.name, clerk(counter, counter.people, Role.EDITOR)
    before = (chest / "text.en.md").read_text("utf-8") if (chest / "text.en.md").exists() else None
    curator.told(f"collection/{key}/text", {"file": "text.en.md", "text": "As the curator saw it."})
    pages = [curator.get(f"/office/collection/{key}{way}?lang=en") for way in ("", "/preview")]
    mark = curator.told(f"collection/{key}")["mark"]
    editor.told(f"collection/{key}/text", {"file": "text.en.md", "text": "As nobody else did."})
    for page in pages:
        told = curator.send(page, "form-publish")
        assert told.status == 409
        assert "changed since you looked at it" in told.text
    assert curator.api(f"collection/{key}/publish", {"seen": mark}).status == 409
    assert ((chest / "text.en.md").read_text("utf-8") if before is not None else None) == before
    assert curator.send(f"/office/collection/{key}/preview?lang=en", "form-publish").status == 200
    assert "As nobody else did." in (chest / "text.en.md").read_text("utf-8")


@pytest.fixture
def meanwhile(monkeypatch):
    """A function that has `act` done while the first draft from now on is checked, by somebody else; what came of it.

    first: before its ways are walked, else after that. Who checks waits for it, ten seconds at most: nobody may have to
    wait for the check.
    """

    def during(act, *, first=False):
        reach, done = Examination.reach, []

        def do() -> None:
            done.append(None)
            done[0] = pool.submit(act).result(10)

        def checked(examination, files, *, wait):
            if first and not done:
                do()
            found = reach(examination, files, wait=wait)
            if not done:
                do()
            return found

        monkeypatch.setattr(Examination, "reach", checked)
        return done

    with ThreadPoolExecutor(1) as pool:
        yield during


def test_a_draft_is_saved_while_another_is_checked(counter, curator, chest, meanwhile):
    key, editor = chest.name, clerk(counter, counter.people, Role.EDITOR)
    curator.told(f"collection/{key}/fields", {"title.en": "Checked"})
    done = meanwhile(lambda: editor.told("collection/chest/fields", {"title.en": "Saved meanwhile"}))
    publish(curator, key)
    assert done == [{"id": "chest", "changed": ["title"]}]
    assert "Checked" in (chest / TOML).read_text("utf-8")
    editor.drop("chest")


@pytest.mark.parametrize("seen", [True, False])
def test_what_changes_while_it_is_checked_is_not_published(counter, curator, chest, meanwhile, seen):
    key, editor, before = chest.name, clerk(counter, counter.people, Role.EDITOR), (chest / TOML).read_bytes()
    curator.told(f"collection/{key}/fields", {"title.en": "Checked"})
    told = {"seen": curator.told(f"collection/{key}")["mark"]} if seen else {}
    meanwhile(lambda: editor.told(f"collection/{key}/fields", {"title.en": "Saved meanwhile"}))
    answer = curator.api(f"collection/{key}/publish", told)
    assert answer.status == 409
    assert json.loads(answer.body)["error"] == "draft-changed"
    assert (chest / TOML).read_bytes() == before
    publish(curator, key)
    assert "Saved meanwhile" in (chest / TOML).read_text("utf-8")


@pytest.mark.parametrize("first", [True, False])
def test_a_draft_that_is_dropped_while_it_is_checked_is_not_published(curator, chest, meanwhile, first):
    """Its files are gone, before they are looked at or after."""
    key, before = chest.name, (chest / TOML).read_bytes()
    curator.told(f"collection/{key}/fields", {"title.en": "Checked"})
    meanwhile(lambda: curator.drop(key), first=first)
    assert curator.api(f"collection/{key}/publish", {}).status == 404
    assert (chest / TOML).read_bytes() == before


@pytest.mark.parametrize("deed", ["publish", "undo"])
def test_a_hall_that_changes_while_a_draft_is_checked_is_checked_with_it(
    counter, curator, chest, meanwhile, deed
):
    """Each is good by itself, and the two stand in each other."""
    key, before, wall = chest.name, (chest / TOML).read_bytes(), {"place.x": "2.5"}
    other = add_exhibit(counter.content, f"{key}-2", EXHIBIT.replace("x = 0.0", "x = -2.5"))
    try:
        curator.told(f"collection/{key}/fields", wall)
        given = {}
        if deed == "undo":
            publish(curator, key)
            curator.told(f"collection/{key}/fields", {"place.x": "0"})
            publish(curator, key)
            given = {"revision": curator.told(f"collection/{key}/history")[0]["id"]}
            before = (chest / TOML).read_bytes()
        text = (other / TOML).read_text("utf-8").replace("x = -2.5", "x = 2.5").replace("z = -1.0", "z = 2.0")
        meanwhile(lambda: (other / TOML).write_text(text, "utf-8"))
        answer = curator.api(f"collection/{key}/{deed}", given)
    finally:
        shutil.rmtree(other)
    assert answer.status == 400
    assert json.loads(answer.body)["error"] == "content-check"
    assert (chest / TOML).read_bytes() == before


def test_the_plan_names_what_stands_there_in_the_language_of_the_page(counter, curator, chest, monkeypatch):
    monkeypatch.setattr(counter.house, "content", load(counter.content))
    key = f"{chest.name}-2"
    curator.told("collection", {"id": key, "title.zh": "另一件", "title.en": "Another"})
    for lang, title in (("zh", "箱"), ("en", "Chest")):
        assert f"<title>{title}</title>" in curator.get(f"/office/collection/{key}/place?lang={lang}").text
    curator.drop(key)


def test_an_editor_drafts_and_does_not_publish(counter, chest):
    one = clerk(counter, counter.people, Role.EDITOR)
    one.told(f"collection/{chest.name}/fields", {"title.en": "Drafted"})
    page = one.get(f"/office/collection/{chest.name}?lang=en").text
    assert "/publish" not in page
    assert "/preview" in page
    one.drop(chest.name)
    assert one.told(f"collection/{chest.name}")["draft"] is None


def test_a_draft_is_dropped_as_it_was_seen(counter, curator, chest):
    at, editor = f"collection/{chest.name}", clerk(counter, counter.people, Role.EDITOR)
    curator.told(f"{at}/fields", {"title.en": "Seen"})
    page, mark = editor.get(f"/office/{at}?lang=en"), curator.told(at)["mark"]
    curator.told(f"{at}/fields", {"title.en": "Written since"})
    for given in ({}, {"seen": ""}, {"seen": mark}):
        assert editor.api(f"{at}/drop", given).status == 409
    refused = editor.send(page, f"/office/{at}/drop")
    assert refused.status == 409
    assert "publish or drop it then" in refused.text
    assert 'value="Written since"' in refused.text
    assert curator.told(at)["draft"] is not None
    assert editor.send(refused, f"/office/{at}/drop").status == 200
    assert curator.told(at)["draft"] is None


def test_an_editor_drops_no_placing_of_a_curator(counter, curator, chest):
    editor, new = clerk(counter, counter.people, Role.EDITOR), f"{chest.name}-2"
    editor.told("collection", {"id": new, "title.zh": "新", "title.en": "New"})
    for key in (chest.name, new):
        at = f"collection/{key}"
        editor.told(f"{at}/fields", {"title.en": "Drafted"})
        assert f"/office/{at}/drop" in editor.get(f"/office/{at}").text
        curator.told(f"{at}/place", {"place.x": "1.5", "place.z": "2.5"})
        mark, before = curator.told(at)["mark"], counter.people.journal.entries(most=1)[0].id
        assert f"/office/{at}/drop" not in editor.get(f"/office/{at}").text, "nobody is shown what he may not"
        assert editor.api(f"{at}/drop", {"seen": mark}).status == 403
        (entry,) = [one for one in counter.people.journal.entries(most=5) if one.id > before]
        assert (entry.who, entry.act, entry.refused) == (editor.person, "place", True)
        assert curator.told(at)["draft"] is not None
        curator.drop(key)
    editor.told("collection", {"id": new, "title.zh": "新", "title.en": "New"})
    editor.drop(new)


def test_an_editor_does_not_move_what_stands_in_the_hall(counter, chest):
    """By whichever way into exhibit.toml: to place is a curator's."""
    key, one, journal = chest.name, clerk(counter, counter.people, Role.EDITOR), counter.people.journal
    before = journal.entries(most=1)[0].id
    moved = (chest / TOML).read_text("utf-8").replace("z = 2.0", "z = 2.5")
    for act, given in (("fields", {"place.z": 2.5}), ("text", {"file": TOML, "text": moved})):
        assert one.api(f"collection/{key}/{act}", given).status == 403
        assert one.told(f"collection/{key}")["draft"] is None
    found = [(one.act, one.refused) for one in journal.entries(most=9) if one.id > before]
    assert found == [("place", True)] * 2
    one.told(f"collection/{key}/fields", {"title.en": "Drafted"})


def test_a_program_gives_numbers_as_numbers(curator, chest):
    key, given = chest.name, {"body.radius": 0.75, "tag": tag(curator, chest.name)}
    assert curator.told(f"collection/{key}/fields", given)["changed"] == ["body.radius"]
    assert "radius = 0.75" in curator.told(f"collection/{key}/text?file={TOML}")["text"]
    for odd in (float("nan"), float("inf"), "-inf"):
        answer = curator.api(f"collection/{key}/fields", {"body.radius": odd})
        assert answer.status == 400
        assert "is no number" in answer.text


def test_of_those_who_make_one_exhibit_at_once_one_does(counter, curator):
    with ThreadPoolExecutor(8) as together:
        for number in range(3):
            key = f"n{uuid.uuid4().hex[:10]}"
            given = {"id": key, "title.zh": "一", "title.en": f"One {number}"}
            answers = together.map(curator.api, ["collection"] * 8, [given] * 8)
            assert sorted(answer.status for answer in answers) == [200] + [409] * 7
            curator.drop(key)


def test_a_draft_whose_file_is_gone_is_shown_and_written_anew(counter, curator, chest):
    """Somebody tidied the data folder by hand."""
    at, editor = f"collection/{chest.name}", clerk(counter, counter.people, Role.EDITOR)
    for name, text in ((TOML, (chest / TOML).read_text("utf-8") + "# more\n"), ("text.en.md", "Drafted.")):
        curator.told(f"{at}/text", {"file": name, "text": text})
    for digest in curator.told(at)["draft"]["files"].values():
        (counter.data / "shelf" / digest).unlink()
    for path in ("collection", at, f"{at}/preview", f"{at}/place", f"{at}/text?file={TOML}"):
        assert curator.get(f"/office/{path}").status == 200, path
        assert curator.api(path).status == 200, path
    told = " ".join(one["what"] for one in curator.told(at)["problems"])
    assert "missing" in told
    assert curator.api(f"{at}/publish", {}).status == 400
    moved = (chest / TOML).read_text("utf-8").replace("z = 2.0", "z = 2.5")
    assert editor.api(f"{at}/text", {"file": TOML, "text": moved}).status == 403
    for name in (TOML, "text.en.md"):
        curator.told(f"{at}/text", {"file": name, "text": f"{(chest / name).read_text('utf-8')}\n"})
    publish(curator, chest.name)


def test_a_long_history_has_pages(counter, curator, chest):
    for number in range(103):
        with counter.people.revisions.adding(
            "console", "publish", chest.name, {f"media/{number}": ("", "0" * 64)}
        ):
            pass
    at = f"/office/collection/{chest.name}/history?lang=en"
    first, second = curator.get(at).text, curator.get(f"{at}&page=2").text
    assert "media/3<" in first
    assert "media/2<" not in first
    assert 'rel="next"' in first
    assert [f"media/{number}<" in second for number in range(4)] == [True, True, True, False]
    listed = [curator.told(f"collection/{chest.name}/history?page={page}") for page in (1, 2, 3)]
    assert list(map(len, listed)) == [100, 3, 0]


def test_nothing_is_read_of_who_may_not_send_it(counter):
    """A researcher's uploads: refused by their head, on the page's door as on the program's."""
    one = clerk(counter, counter.people, Role.RESEARCHER)
    cookie = "; ".join(f"{name}={value}" for name, value in one.cookies.items())
    before = counter.people.journal.entries(most=1)[0].id
    for door in ("office", "api/office"):
        line = http.client.HTTPConnection(urlsplit(counter.url).netloc, timeout=30)
        line.putrequest("POST", f"/{door}/collection/chest/upload")
        head = {"Cookie": cookie, "Origin": counter.url, "X-Seal": one.seal, "Content-Length": "200000000"}
        for name, value in (head | {"Content-Type": "multipart/form-data; boundary=x"}).items():
            line.putheader(name, value)
        line.endheaders()
        assert line.getresponse().status == 403, door
        line.close()
    found = [
        (entry.act, entry.refused) for entry in counter.people.journal.entries(most=9) if entry.id > before
    ]
    assert found == [("draft", True)] * 2


def test_drafts_have_a_quota(counter, curator, chest, monkeypatch):
    noise = io.BytesIO()
    Image.effect_noise((900, 900), 90).convert("RGB").save(noise, "PNG")
    from hall_app.house.drafts import Shelf

    monkeypatch.setattr(Shelf, "size", lambda self: 49_999_000)
    answer = curator.bring(chest.name, [("noise.png", noise.getvalue())], use="picture")
    assert answer.status == 413
    assert json.loads(answer.body)["error"] == "quota"


def test_what_was_taken_out_of_a_draft_makes_room(counter, curator, chest, monkeypatch):
    from hall_app.house.drafts import Shelf

    shelf, size, noise = counter.data / "shelf", Shelf.size, [io.BytesIO() for _ in range(3)]
    for data in noise:
        Image.effect_noise((200, 200), 90).convert("RGB").save(data, "PNG")
    full = sum(one.stat().st_size for one in shelf.iterdir()) if shelf.is_dir() else 0
    full += 2 * len(noise[0].getvalue())
    monkeypatch.setattr(Shelf, "size", lambda self: size(self) + 50_000_000 - full)
    for data in noise:
        answer = curator.bring(chest.name, [("noise.png", data.getvalue())], use="picture")
        assert answer.status == 200, answer.text
        (name,) = json.loads(answer.body)["files"]
        curator.told(f"collection/{chest.name}/remove", {"file": name})


def test_every_plain_key_of_the_schema_has_words():
    from hall_app.web.platform.office.collection import WORDS, keys_of

    keys = keys_of(
        "title", "caption", "licence", "thumbnail", "questionnaire", "size_range", "body", "record", "place"
    )
    assert len(keys) > 20
    assert {key.name for key in keys} <= WORDS.keys()
    assert all(zh and en for zh, en in WORDS.values())


def test_no_path_leads_out_of_the_exhibit(curator, chest):
    for name in (
        "../../hall.toml",
        "baked/../exhibit.toml",
        "baked/../../../hall.toml",
        "media/../exhibit.toml",
        "",
        "/etc/passwd",
    ):
        assert curator.ask("GET", f"/office/collection/{chest.name}/file?name={name}").status == 404, name
        assert curator.api(f"collection/{chest.name}/text?file={name}").status == 404
    for key in ("..", "hall", "%2e%2e", "a/b"):
        assert curator.ask("GET", f"/office/collection/{key}").status == 404
