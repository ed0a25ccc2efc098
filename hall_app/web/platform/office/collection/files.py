"""Pictures, models, scans, sound and film of an exhibit: brought, shown, taken out."""

from __future__ import annotations

import json
import posixpath
import threading
from collections.abc import Callable, Iterator, Mapping
from html import escape
from pathlib import Path
from typing import Any

from hall_app.content.files import BAKED, TEXTS, replace_file, whole_digest
from hall_app.content.views.scene import media_type
from hall_app.house.drafts import LARGEST, TEXT_FILES, USES, Taken, beside, portrait, shape, take_in
from hall_app.house.people import PeopleError
from hall_app.web.collection.table import Change
from hall_app.web.pages.frame import part
from hall_app.web.platform.counter import Asking, Download, Field, Shown, button, form
from hall_app.web.platform.office.collection.desk import Desk
from hall_app.web.platform.office.collection.keys import changes_of, fields_of, media_keys
from hall_app.web.platform.office.table import office_page

__all__ = ["MOST_FILES", "TURN", "Uploads", "drawn_model", "file_address", "media_part", "shown_medium"]

MOST_FILES = 12  # at once
MOST_DRAWN = 300  # pictures and shapes of models that are kept, two megabytes each at most
_DRAWN_WITHIN = 120.0  # [s] a scan of five million triangles takes a minute of a busy machine
TURN = "book/turn.js"  # the script of pages that show models
_SOLID = (".glb", ".ply", ".obj")
_DRAWING = threading.Lock()
_ASKED = threading.BoundedSemaphore(2)  # who waits keeps a thread, and there are few
_MEDIA = {"picture": "picture", "film": "video", "sound": "audio"}  # use -> kind in exhibit.toml


class Uploads:
    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def bring(self, asking: Asking) -> dict[str, Any]:
        """Into the draft, and named in exhibit.toml for its use."""
        desk, key, use = self._desk, self._desk.key(asking), asking.form.get("use", "picture")
        came = [one for one in asking.files if one.name or one.size]
        if not came or use not in USES:
            raise PeopleError("no-upload")
        taken = [take_in(one.name, one.file, one.size, use) for one in came]
        with desk.drafts.lock:
            names = desk.drafts.files(key)
            table = desk.table(key)
            files: dict[str, bytes | None] = {}
            changes: list[Change] = []
            media = table.get("media")
            count = len(media) if isinstance(media, list) else 0
            for one in taken:
                name = _free(one, {*names, *files})
                files[name] = one.data
                if use in _MEDIA:
                    changes += [Change(("media", count, "kind"), None, _MEDIA[use])]
                    changes += [Change(("media", count, "file"), None, name)]
                    typed = {
                        f"media[{count + 1}].{part}": asking.form.get(part, "")
                        for part in ("alt.zh", "alt.en", "caption.zh", "caption.en")
                    }
                    changes += changes_of(typed, media_keys(count), {})
                    count += 1
                else:
                    changes += _as_model(table, use, name)
            if use not in _MEDIA:
                files |= dict.fromkeys(self._replaced(key, table, use, names))
            desk.change(asking, key, changes, files=files)
        brought = (name for name, data in files.items() if data is not None)
        return {"id": key, "files": {name: one.told for name, one in zip(brought, taken, strict=True)}}

    def _replaced(self, key: str, table: Mapping[str, Any], use: str, names: Mapping[str, str]) -> list[str]:
        """Files it was made of that nothing names once another has their place: the check would refuse them."""
        models, scan = table.get("models"), table.get("scan")
        models = models if isinstance(models, Mapping) else {}
        gone = [scan, *(models.values() if use == "scan" else [models.get(use)])]
        kept = {part: value for part, value in table.items() if part not in ("models", "scan")}
        if use != "scan":
            kept["models"] = {part: value for part, value in models.items() if part != use}
        drafts, named = self._desk.drafts, set(_texts_in(kept))
        texts = [drafts.text(key, name) for name in TEXTS.values()]
        return [
            name
            for name in gone
            if isinstance(name, str)
            and name in names.keys() - named
            and not any(name in text for text in texts)
        ]

    def remove(self, asking: Asking) -> dict[str, Any]:
        """A file out of the draft, and the medium that shows it."""
        desk, key, name = self._desk, self._desk.key(asking), asking.form.get("file", "")
        if name in TEXT_FILES or name not in desk.drafts.files(key):
            raise PeopleError("no-file")
        media = desk.table(key).get("media")
        listed = media if isinstance(media, list) else []
        shows = [
            number
            for number, one in enumerate(listed)
            if isinstance(one, dict) and (one.get("file") == name or one.get("files") == [name])
        ]
        changes = [Change(("media", number), None, None) for number in reversed(shows)]
        if shows and len(shows) == len(listed):
            changes = [Change(("media",), None, None)]
        desk.change(asking, key, changes, files={name: None})
        return {"id": key, "file": name}

    def facts(self, asking: Asking) -> dict[str, Any]:
        name, path = self._asked(asking)
        return {"name": name, "size": path.stat().st_size, "type": media_type(name)}

    def shown(self, asking: Asking) -> Download:
        """The file itself, as it is to be; nothing in it runs, and it is a page of no kind."""
        name, path = self._asked(asking)
        return Download(path, posixpath.basename(name), media_type(name), inline=True)

    def picture(self, asking: Asking) -> Download:
        """A model or scan drawn."""
        name, path = self._asked(asking)
        kept = self._made(name, path, ".jpg", portrait)
        return Download(kept, f"{posixpath.basename(name)}.jpg", "image/jpeg", inline=True)

    def turned(self, asking: Asking) -> Download:
        """The same as triangles, which a page turns."""
        name, path = self._asked(asking)
        kept = self._made(name, path, ".shape", shape)
        return Download(kept, f"{posixpath.basename(name)}.shape", "application/octet-stream")

    def _made(self, name: str, path: Path, kind: str, make: Callable[[Path, str], bytes]) -> Path:
        """Kept for the next who asks; made one at a time, since that takes seconds. Raises PeopleError."""
        ending = posixpath.splitext(name)[1]
        if ending not in _SOLID:
            raise PeopleError("no-file")
        kept = self._desk.house.data / "portraits" / f"{whole_digest(path)}{kind}"
        if not kept.is_file():
            if not _ASKED.acquire(blocking=False):
                raise PeopleError("too-often", seconds=10)
            try:
                with _DRAWING:
                    if (
                        not kept.is_file()
                        and (made := beside(make, path, ending, within=_DRAWN_WITHIN)) is not None
                    ):
                        replace_file(kept, made)
                        _keep_newest(kept.parent)
            finally:
                _ASKED.release()
            if not kept.is_file():
                raise PeopleError("file-broken", name=name, why="it cannot be drawn")
        return kept

    def _asked(self, asking: Asking):
        key, name = self._desk.key(asking), asking.query.get("name", "")
        if name in TEXT_FILES or not (name in self._desk.drafts.files(key) or name.startswith(BAKED)):
            raise PeopleError("no-file")
        if media_type(name) == "application/octet-stream" and not name.endswith(_SOLID):
            raise PeopleError("no-file")
        return name, self._desk.drafts.path(key, posixpath.normpath(name))

    def page(self, asking: Asking) -> Shown:
        """The form by itself, where it is refused."""
        desk, key = self._desk, self._desk.key(asking)
        back = asking.word("回到展品", "Back to the exhibit")
        way = f'<p class="doors"><a href="{asking.address(f"/office/collection/{key}")}">{back}</a></p>'
        inside = _upload_form(asking, key) + way
        return office_page(asking, desk.title(key, asking.lang), inside, path=f"collection/{key}")


def _keep_newest(folder: Path) -> None:
    """Let go of what was drawn long ago: it is drawn again for who asks, and counts for no quota."""
    drawn = sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime_ns)
    for path in drawn[:-MOST_DRAWN]:
        path.unlink(missing_ok=True)


def _free(one: Taken, names: set[str]) -> str:
    """A name that no other file has: a new picture never takes an old one's place."""
    folder = "scan" if one.kind == "scan" else "media"
    stem, _, ending = one.name.rpartition(".")
    number = 1
    while (name := f"{folder}/{stem}{f'-{number}' if number > 1 else ''}.{ending}") in names:
        number += 1
    return name


def _as_model(table: Mapping[str, Any], use: str, name: str) -> list[Change]:
    """What makes an exhibit's own file its model, in place of what it was made of."""
    if use == "scan":
        gone = [one for one in ("models", "outfit", "show") if one in table and one != "show"]
        return [Change((one,), None, None) for one in gone] + [Change(("scan",), None, name)]
    gone = [one for one in ("outfit", "scan", "scanned", "show") if one in table]
    return [Change((one,), None, None) for one in gone] + [Change(("models", use), None, name)]


def _texts_in(value: Any) -> Iterator[str]:
    """All texts of a table, however deep."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for one in value.values() if isinstance(value, Mapping) else value:
            yield from _texts_in(one)


def file_address(asking: Asking, key: str, name: str) -> str:
    """Where the office shows a file of an exhibit."""
    return escape(asking.address(f"/office/collection/{key}/file", name=name))


def _upload_form(asking: Asking, key: str) -> str:
    word = asking.word
    uses = {
        "picture": word("图片（可多选）", "Pictures, several at once"),
        "hall": word("展厅模型（GLB）", "Model in the hall (GLB)"),
        "close": word("近观模型（GLB）", "Model of the close-up (GLB)"),
        "scan": word("扫描（GLB、PLY、OBJ）", "Scan (GLB, PLY, OBJ)"),
        "film": word("影片（WebM、MP4）", "Film (WebM, MP4)"),
        "sound": word("声音（Ogg、MP3、WAV…）", "Sound (Ogg, MP3, WAV …)"),
    }
    most = {kind: size // 1_000_000 for kind, size in LARGEST.items()}
    hint = word(
        "按内容辨认；图片重新编码，影片与声音经解码检查，必要时转换；附带信息（地点、相机）一律去除；"
        "SVG 只留下会画出来的部分。压缩包不收。"
        f"上限：图片 {most['picture']} MB、SVG {most['drawing']} MB、模型 {most['model']} MB、"
        f"扫描 {most['scan']} MB、影片 {most['film']} MB、声音 {most['sound']} MB。",
        "Known by what they hold; pictures are drawn anew, film and sound decoded and, where browsers do not play "
        "them, encoded again, all without what a camera wrote into them; of an SVG stays what draws. No archives. "
        f"At most: pictures {most['picture']} MB, SVG {most['drawing']} MB, models {most['model']} MB, "
        f"scans {most['scan']} MB, films {most['film']} MB, sound {most['sound']} MB.",
    )
    large = word(
        f"扫描超过 {most['scan']} MB，或附有贴图、.mtl 文件的：请直接放入内容文件夹 exhibits/{key}/scan/，"
        f'并在 exhibit.toml 中写 scan = "scan/文件名"；本页随即显示。可至 1 GB、五百万个三角形。',
        f"A scan of more than {most['scan']} MB, or one with pictures or a .mtl file beside it: put it into the "
        f"content folder by hand, in exhibits/{key}/scan/, and write "
        'scan = "scan/NAME" into exhibit.toml. It is shown here then. 1 GB and five million triangles at most.',
    )
    fields = (
        Field("use", word("用途", "Use"), "select", choices=uses),
        Field("file", word("文件", "Files"), "file", hint=hint, given={"multiple": "multiple"}),
        *(
            Field(
                f"alt.{lang}",
                word(f"画面描述（{zh}）", f"What it shows ({en})"),
                needed=False,
                given={"lang": lang},
            )
            for lang, zh, en in (("zh", "中文", "Chinese"), ("en", "英文", "English"))
        ),
    )
    sent = form(
        asking,
        "upload",
        f"/office/collection/{key}/upload",
        fields,
        word("上传到草稿", "Upload to the draft"),
    )
    sent = sent.replace('<form method="post"', '<form method="post" enctype="multipart/form-data"', 1)
    return f'{sent}<p class="quiet">{escape(large)}</p>'


def media_part(desk: Desk, asking: Asking, key: str, table: Mapping[str, Any], tag: str) -> str:
    """What the exhibit shows and sounds, with its words, and a way to bring more."""
    word, parts = asking.word, []
    media = table.get("media")
    for number, one in enumerate(media if isinstance(media, list) else []):
        if not isinstance(one, dict):
            continue
        names = _named(one)
        at = f"/office/collection/{key}"
        keys = media_keys(number) if one.get("kind") != "picture" else media_keys(number)[:2]
        words = form(
            asking, f"medium-{number}", f"{at}/fields", fields_of(asking, keys, table), word("保存", "Save"),
            hidden={"tag": tag}, style="pairs",
        )  # fmt: skip
        own = bool(names) and names[0] in desk.drafts.files(key)
        goes = (
            button(
                asking,
                "remove",
                f"{at}/remove",
                word("移除", "Remove"),
                about=names[0],
                hidden={"file": names[0]},
            )
            if own and len(names) == 1
            else ""
        )
        told = one.get("caption") or one.get("alt")
        words_of = _word_of(told, asking.lang)
        named = f'<code class="quiet">{escape(", ".join(names))}</code>'
        title = f"<b>{escape(words_of or str(number + 1))}</b> · {named}"
        parts.append(
            f"<li>{shown_medium(asking, key, one, names)}"
            f"<details><summary>{title}</summary>{words}{goes}</details></li>"
        )
    title = word("图片、影片、声音与模型", "Pictures, films, sounds, models")
    models, scan = table.get("models"), table.get("scan")
    named = [*(models.values() if isinstance(models, dict) else ()), scan]
    own = [one for one in named if isinstance(one, str) and one in desk.drafts.files(key)]
    drawn = "".join(drawn_model(asking, key, name) for name in own)
    parts += [f'<li class="drawn">{drawn}</li>'] if drawn else []
    listed = f'<ul class="media">{"".join(parts)}</ul>' if parts else ""
    return part("media", title, f'{listed}<div class="desk">{_upload_form(asking, key)}</div>')


def _named(one: Mapping[str, Any]) -> list[str]:
    """The files of a medium as exhibit.toml has it; what is no name there is none."""
    given = one["file"] if one.get("file") else one.get("files")
    listed = given if isinstance(given, list) and not one.get("file") else [given]
    return [name for name in listed if isinstance(name, str)]


def _word_of(pair: Any, lang: str) -> str:
    text = pair.get(lang) if isinstance(pair, Mapping) else None
    return text if isinstance(text, str) else ""


def drawn_model(asking: Asking, key: str, name: str, told: str = "") -> str:
    """A model or scan as a picture of it, which the script TURN lets one turn. told: HTML of what is known of it."""
    at, word = f"/office/collection/{key}", asking.word
    picture = escape(asking.address(f"{at}/picture", name=name))
    alt = f"{word('模型的形体', 'Shape of the model')} {escape(name)}"
    words = {
        "turn": word("转动查看", "Turn it"),
        "coming": word("正在准备 …", "Getting it ready …"),
        "failed": word("现在无法转动，请稍后再试。", "It cannot be turned just now: try again in a while."),
        "fewer": word(
            "预览用 {shown} 个三角形，文件有 {of} 个",
            "{shown} triangles for the preview, of {of} in the file",
        ),
        "keys": word("方向键转动，+ 与 − 远近", "arrow keys turn it, + and − bring it closer or farther"),
        "left": word("向左转", "Turn left"),
        "right": word("向右转", "Turn right"),
        "up": word("从上方看", "From above"),
        "down": word("从下方看", "From below"),
        "closer": word("近些", "Closer"),
        "farther": word("远些", "Farther"),
    }
    return f'''<figure data-shape="{escape(asking.address(f"{at}/shape", name=name))}"
 data-words="{escape(json.dumps(words, ensure_ascii=False))}">
<img src="{picture}" alt="{alt}" loading="lazy" width="480" height="600">
<figcaption><code>{escape(name)}</code>{told}</figcaption></figure>'''


def shown_medium(asking: Asking, key: str, one: Mapping[str, Any], names: list[str]) -> str:
    """A medium as HTML, from the draft's own files."""
    if not names:
        return '<span class="blank"></span>'
    words = escape(_word_of(one.get("alt"), asking.lang))
    if one.get("kind") == "picture":
        return f'<img src="{file_address(asking, key, names[0])}" alt="{words}" loading="lazy">'
    sources = "".join(
        f'<source src="{file_address(asking, key, name)}" type="{media_type(name, str(one.get("kind", "")))}">'
        for name in names
    )
    label = words or escape(names[0])
    if one.get("kind") == "video":
        return f'<video controls preload="none" aria-label="{label}">{sources}</video>'
    return f'<audio controls preload="none" aria-label="{label}">{sources}</audio>'
