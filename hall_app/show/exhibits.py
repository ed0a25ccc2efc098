"""What the exhibits are drawn with: read from the content's files and from bakes, beside the event loop."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from hall_app.content.bakes.models import ExhibitModels, models_of
from hall_app.content.bakes.store import key_now
from hall_app.content.files import is_there
from hall_app.content.floor.footprints import foot_height
from hall_app.content.folder import Content, Exhibit
from hall_app.content.models.glb import GlbError, read_glb
from hall_app.content.problems import Problem
from hall_app.show.scene import Figure, Model

__all__ = ["Drawn", "drawn_exhibits"]

_FIRST = 10  # exhibits that come before a visitor can enter; what else there is comes while he walks
_ASIDE = math.radians(50.0)  # from where he looks first, that a wide picture shows


@dataclass(frozen=True)
class Drawn:
    """figures: of the exhibits that stand in the hall; models: exhibit -> its files; keys: exhibit with a garment ->
    key of the bake of its present inputs; unreadable: models that cannot be read."""

    figures: tuple[Figure, ...]
    models: dict[str, ExhibitModels]
    keys: dict[str, str | None]
    unreadable: tuple[Problem, ...]


def drawn_exhibits(
    content: Content,
    data: Path,
    last: Mapping[str, ExhibitModels] | None = None,
    shown: Mapping[str, Figure] | None = None,
) -> Drawn:
    """Read what the content's exhibits are drawn with now. Opens and hashes files: tens of milliseconds.

    last, shown: what stood in the hall until now. A garment whose inputs changed keeps its last models until it is
    baked; an exhibit whose models are missing or cannot be read keeps the figure it had, or is left out.
    """
    figures: list[Figure] = []
    models: dict[str, ExhibitModels] = {}
    problems: list[Problem] = []
    for exhibit in content.exhibits:
        former, figure = (last or {}).get(exhibit.id), (shown or {}).get(exhibit.id)
        if former is not None and figure is not None and _own_model_missing(exhibit):
            found = former  # the content's own problems name the file
        elif (found := _models(content, exhibit, data, former)) is None:
            continue
        else:
            try:
                compared = _compared(exhibit)
            except (GlbError, OSError) as error:  # the exhibit itself is shown all the same
                compared = None
                problems.append(Problem(exhibit.toml, "comparison.model", str(error), _fix(error)))
            try:
                figure = _figure(content, exhibit, found, compared)
            except (GlbError, OSError) as error:
                what = f"{found.close.name}, {found.hall.name}: {error}"
                problems.append(Problem(exhibit.toml, "models", what, _fix(error)))
        if figure is not None:
            models[exhibit.id] = found
            figures.append(figure)
    first = _first_seen(content, figures)
    figures = [replace(figure, first=figure.id in first) for figure in figures]
    keys = {e.id: key_now(content, e) for e in content.exhibits if e.file.baked_key is not None}
    return Drawn(tuple(figures), models, keys, tuple(problems))


def _first_seen(content: Content, figures: Iterable[Figure]) -> frozenset[str]:
    """Those that stand in the picture at the entrance, the nearest first, then what stands aside of it or behind."""
    start = content.hall.start
    ahead = math.radians(start.facing)

    def rank(figure: Figure) -> tuple[bool, float]:
        x, z = figure.x - start.x, figure.z - start.z
        return abs(math.remainder(math.atan2(x, z) - ahead, math.tau)) > _ASIDE, math.hypot(x, z)

    return frozenset(figure.id for figure in sorted(figures, key=rank)[:_FIRST])


def _fix(error: GlbError | OSError) -> str:
    return error.fix if isinstance(error, GlbError) else "check the file"


def _own_model_missing(exhibit: Exhibit) -> bool:
    """Whether a ready-made model that is named is not there: deleted, renamed, or being copied."""
    named = exhibit.file.models
    files = () if named is None else (named.hall, named.close or named.hall)
    return any(not is_there(exhibit.folder / file) for file in files)


def _models(
    content: Content, exhibit: Exhibit, data: Path, last: ExhibitModels | None
) -> ExhibitModels | None:
    """What to draw it with: the bake of its present inputs, else what is shown, else the last bake there is."""
    fresh = models_of(content, exhibit, data, stale=False)
    if fresh is not None:
        return fresh
    if last is not None and last.baked is not None and exhibit.file.baked_key is not None and last.whole():
        return last
    return models_of(content, exhibit, data)


def _held(model: Path) -> Callable[[], bytes]:
    """Its bytes as they are now: a curator may write a ready-made file in its place, nobody writes into a bake."""
    data = model.read_bytes()
    return lambda: data


def _figure(content: Content, exhibit: Exhibit, models: ExhibitModels, compared: Model | None) -> Figure:
    place = exhibit.file.place
    read_glb(models.hall)  # a browser would only show a hole
    return Figure(
        id=exhibit.id,
        hall=models.hall.read_bytes(),
        close=_model(models.close, baked=models.baked is not None),
        x=place.x,
        y=foot_height(content.plan, exhibit.file),
        z=place.z,
        facing=place.facing,
        compared=compared,
    )


def _compared(exhibit: Exhibit) -> Model | None:
    """What its close-up shows side by side; a missing file is named by the content's own problems."""
    path = exhibit.compared_path()
    return None if path is None else _model(path, baked=False)


def _model(path: Path, *, baked: bool) -> Model:
    info = read_glb(path)
    glb = path.read_bytes if baked else _held(path)
    return Model(glb, (info.low[1] + info.high[1]) / 2, 0.5 * math.dist(info.low, info.high))
