"""The collection as values: what every format tells of the hall and of each exhibit, addresses made out.

`collection_of` is the only one here that looks at files (sizes, digests, dates); documents are made of its value alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

from hall_app.content.bakes.models import ExhibitModels
from hall_app.content.bakes.store import RECORD
from hall_app.content.files import TEXTS
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.pictures import PictureError, picture_size
from hall_app.content.schema.exhibit import Media, Record
from hall_app.content.schema.values import Bilingual
from hall_app.content.views.markdown import plain_text
from hall_app.content.views.scene import RECORD_LABELS, media_file, media_type, media_url, thumbnail
from hall_app.web.collection.licences import licence_address

__all__ = ["GLB", "LANGUAGES", "Collection", "Item", "Medium", "Model", "Source", "collection_of"]

LANGUAGES = ("zh", "en")
GLB = "model/gltf-binary"
Kind = Literal["simulated", "scanned", "model"]
ModelsOf = Callable[[str], ExhibitModels | None]
_KINDS: dict[str | None, Kind] = {"outfit": "simulated", "scan": "scanned", None: "model"}


@dataclass(frozen=True)
class Source:
    """A file with an address. width, height: of a picture whose size in pixels is known, else 0."""

    url: str
    type: str
    width: int = 0
    height: int = 0


@dataclass(frozen=True)
class Medium:
    """A picture, film or sound, in one or several formats."""

    kind: Literal["picture", "video", "audio"]
    sources: tuple[Source, ...]
    alt: Bilingual | None
    caption: Bilingual | None
    poster: str | None

    @property
    def label(self) -> Bilingual | None:
        """What it is called in a list."""
        return self.caption or self.alt


@dataclass(frozen=True)
class Model:
    """The fine GLB of an exhibit: where it is downloaded with its licence, and its size [bytes] as it lies there."""

    url: str
    path: Path
    size: int


@dataclass(frozen=True)
class Item:
    """One exhibit. text: its whole text without marks; changed: when a file of its was last written."""

    id: str
    kind: Kind
    title: Bilingual
    caption: Bilingual | None
    text: Bilingual
    record: Record
    media: tuple[Medium, ...]
    thumbnail: Source | None
    model: Model
    licence: str
    changed: datetime

    @property
    def rights(self) -> str | None:
        """The licence's address, where it has one."""
        return licence_address(self.licence)

    @property
    def pictures(self) -> Iterator[tuple[Medium, Source]]:
        """Its pictures whose size in pixels is known."""
        for medium in self.media:
            for source in medium.sources[:1]:
                if medium.kind == "picture" and source.width:
                    yield medium, source

    def lines(self) -> Iterator[tuple[Bilingual, Bilingual]]:
        """(label, value) of every line of its record, as the catalogue shows them."""
        for name, (zh, en) in RECORD_LABELS.items():
            if (value := getattr(self.record, name)) is not None:
                yield Bilingual(zh=zh, en=en), value
        for line in self.record.line:
            yield line.label, line.value


@dataclass(frozen=True)
class Collection:
    """The hall and its exhibits. address: where it is found, without a / at its end; "" makes addresses relative."""

    address: str
    title: Bilingual
    subtitle: Bilingual
    about: Bilingual | None
    licence: str
    contact: str | None
    items: tuple[Item, ...]

    def item(self, identity: str) -> Item | None:
        """The exhibit of that id, or None."""
        return next((item for item in self.items if item.id == identity), None)

    def at(self, path: str) -> str:
        """The address of a path that begins with /."""
        return self.address + path

    def page(self, item: Item) -> str:
        """Where a reader finds it in the catalogue."""
        return self.at(f"/catalogue#exhibit-{item.id}")

    @property
    def host(self) -> str:
        """The name of the machine it is found on."""
        return urlsplit(self.address).hostname or "localhost"

    @property
    def earliest(self) -> datetime:
        """Before that, nothing was written."""
        return min((item.changed for item in self.items), default=datetime(2026, 1, 1, tzinfo=UTC))


def collection_of(content: Content, models: ModelsOf, address: str) -> Collection:
    """What the content folder holds now. models(id): the GLBs an exhibit is shown with, None while it has none.

    address: under which the hall was asked; the one that hall.toml states goes before it. Exhibits without a model do
    not stand in the hall and are left out.
    """
    hall = content.hall
    address = (hall.address or address).rstrip("/")
    found = [(exhibit, shown) for exhibit in content.exhibits if (shown := models(exhibit.id)) is not None]
    items = tuple(_item(content, exhibit, shown, address) for exhibit, shown in found)
    return Collection(address, hall.title, hall.subtitle, hall.about, hall.licence, hall.contact, items)


def _item(content: Content, exhibit: Exhibit, models: ExhibitModels, address: str) -> Item:
    file, baked = exhibit.file, models.baked
    small = thumbnail(exhibit, baked)
    media = [_medium(exhibit, medium, baked, address) for medium in file.media]
    return Item(
        exhibit.id,
        _KINDS[file.baked_key],
        file.title,
        file.caption,
        Bilingual(zh=_plain(exhibit.text_zh, file.title.zh), en=_plain(exhibit.text_en, file.title.en)),
        file.record,
        tuple(medium for medium in media if medium.sources),
        Source(address + small, media_type(urlsplit(small).path)) if small else None,
        Model(f"{address}/collection/{exhibit.id}/model.glb", models.close, models.close.stat().st_size),
        file.licence,
        _changed(content.folder, exhibit, models),
    )


def _plain(markdown: str, title: str) -> str:
    """A text of pictures alone is told by the exhibit's title."""
    return plain_text(markdown) or title


def _medium(exhibit: Exhibit, medium: Media, baked: Path | None, address: str) -> Medium:
    found = [_source(exhibit, path, medium.kind, baked, address) for path in medium.sources]
    sources = tuple(source for source in found if source is not None)
    poster = _source(exhibit, medium.poster, "picture", baked, address) if medium.poster else None
    return Medium(medium.kind, sources, medium.alt, medium.caption, poster.url if poster else None)


def _source(exhibit: Exhibit, path: str, kind: str, baked: Path | None, address: str) -> Source | None:
    """A file of the exhibit, None while it is not there."""
    file = media_file(exhibit, path, baked)
    url = media_url(exhibit.id, path, file)
    if url is None:
        return None
    width, height = _pixels(file) if kind == "picture" else (0, 0)
    return Source(address + url, media_type(path, kind), width, height)


def _pixels(file: Path) -> tuple[int, int]:
    """(width, height) of a picture, (0, 0) of a drawing without pixels."""
    try:
        return picture_size(file.read_bytes())
    except PictureError:
        return 0, 0


def _changed(root: Path, exhibit: Exhibit, models: ExhibitModels) -> datetime:
    """When one of the files that the records are made of was last written, in whole seconds."""
    folder, baked = exhibit.folder, models.baked
    named = [path for medium in exhibit.file.media for path in medium.sources]
    files = [root / "hall.toml", folder / "exhibit.toml", *(folder / name for name in TEXTS.values())]
    files += [models.close, *(media_file(exhibit, path, baked) for path in named)]
    files += [baked / RECORD] if baked is not None else []
    times = [file.stat().st_mtime for file in files if file.is_file()]
    return datetime.fromtimestamp(int(max(times, default=0)), UTC)
