"""What SOURCE of the command names: a draft with its harness and colours, and the cloth it can be woven into.

The draft is answered for every file that can be read; the cloth (yarns, sett, a size that can be relaxed) may fail.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from sim_core.errors import FileProblem, WeaveError
from sim_core.weave.draft.algebra import Harness, harness
from sim_core.weave.draft.analysis import FloatLengths, Summary, craft_floats, summary, summary_of_factors
from sim_core.weave.draft.draft import Draft
from sim_core.weave.draft.factors import Factors
from sim_core.weave.draft.generators import damask
from sim_core.weave.draft.notation import PICTURES, draft_of_words, motif_of
from sim_core.weave.files.wif.model import Wif, thread_colours
from sim_core.weave.files.wif.sections import listed
from sim_core.weave.model import Weave, draft_from_dict
from sim_core.weave.weave_file import Published, read_published
from sim_core.weave.yarn import Yarn

__all__ = ["Source", "blocked_source", "dressed", "source_of", "source_of_wif", "weave_of"]

# What a bare draft is woven of: degummed silk, two threads of 20/22 den; an assumption, told in the provenance.
TEX, DIAMETER, FLATTENING, ROOM = 3.59e-6, 78e-6, 1.8, 1.7
ASSUMED = (
    f"assumed: degummed silk of {TEX * 1e6:.2f} tex, {DIAMETER * 1e6:.0f} um, flattened {FLATTENING}, "
    f"spaced {ROOM} widths"
)


@dataclass(frozen=True, eq=False)
class Source:
    """A draft as it was given.

    factors: its lift.  palette: (n, 3) uint8 sRGB.  warp_colours (ends,), weft_colours (picks,): rows of the palette.
    wif: the file of another program, None for drafts of ours.  made: the cloth and where its yarns and sett come from,
    None where it is woven on demand.  remarks: what the reader replaced.  published: what the weave file says that
    others measured.
    """

    name: str
    factors: Factors
    palette: np.ndarray
    warp_colours: np.ndarray
    weft_colours: np.ndarray
    wif: Wif | None = None
    made: tuple[Weave, str] | None = None
    path: str = ""
    remarks: tuple[str, ...] = ()
    published: Published | None = None

    @property
    def plan(self) -> bool:
        """Whether the harness is told as a lift plan."""
        return self.wif is not None and self.wif.plan

    @cached_property
    def harness(self) -> Harness:
        """That of the file, else the one of the fewest shafts."""
        if self.wif is not None:
            return self.wif.harness
        return harness(self.factors.lift())

    @cached_property
    def facts(self) -> Summary:
        """Repeat, face, floats, interlacings, integrity; no physics."""
        if self.made is not None:
            return summary(_structure(self.made[0].draft))
        return summary_of_factors(self.factors)

    @cached_property
    def floats(self) -> dict[str, FloatLengths | None]:
        """Floats of warp, weft and extra wefts as a weaver counts them; None where none are meant."""
        if self.made is not None:
            return craft_floats(self.made[0].draft)
        return {"warp": self.facts.warp, "weft": self.facts.weft}

    @cached_property
    def weave(self) -> tuple[Weave, str]:
        """The cloth, and where its yarns and sett come from; raises WeaveError where it cannot be woven."""
        if self.made is not None:
            return self.made
        assert self.wif is not None
        try:
            return _woven(self.wif, Path(self.path).name)
        except WeaveError as error:
            raise WeaveError(f"{self.path}: {error}") from error


def source_of(words: str) -> Source:
    """The draft that SOURCE names; raises WeaveError or FileProblem: what, where, and the remedy."""
    path = Path(words)
    kind = path.suffix.lower()
    if kind in (".wif", ".dtx"):
        return _from_draft(path)
    if kind == ".toml":
        return replace(_ours(Weave.load(path), path.name), published=read_published(path))
    if kind == ".json":
        return _ours(*_from_json(path))
    if kind in PICTURES:
        return _ours(dressed(damask(motif_of(path), longest=8, name=path.stem)), ASSUMED)
    if path.is_dir():
        raise FileProblem(f"{path}: a folder – give a file, such as a .wif")
    if path.is_file():
        raise FileProblem(
            f"{path}: no kind of file that can be read – let the program that made it save it as WIF (.wif)"
        )
    return _ours(dressed(draft_of_words(words)), ASSUMED)


def weave_of(words: str) -> tuple[Weave, str]:
    """The cloth that SOURCE names, and where its yarns and sett come from; raises as `source_of` does."""
    return source_of(words).weave


def dressed(draft: Draft) -> Weave:
    """A bare draft with yarns and sett of a plain silk."""
    yarn = Yarn(DIAMETER, TEX, FLATTENING, unevenness=0.05)
    sett = 1 / (ROOM * yarn.width)
    return Weave(
        draft.name,
        draft,
        yarn,
        yarn,
        sett,
        sett,
        extra=yarn if draft.channels.pick_kind is not None else None,
    )


def _from_draft(path: Path) -> Source:
    """The draft of another program."""
    if path.suffix.lower() == ".wif":
        from sim_core.weave.files.wif.reader import read_wif as read
    else:
        from sim_core.weave.files.dtx import read_dtx as read
    return source_of_wif(read(path), path)


def blocked_source(profile: Source, structure: str) -> Source:
    """A profile draft blocked out by a structure; raises WeaveError as `blocked_out` does."""
    from sim_core.weave.files.profiles import blocked_out

    given = profile.wif or Wif(profile.name, profile.harness)
    return source_of_wif(blocked_out(given, structure), Path(profile.path or profile.name))


def source_of_wif(wif: Wif, path: Path) -> Source:
    """The draft of a file that was read; raises WeaveError where it is too large to be counted."""
    try:
        factors, made = wif.factors, wif.weave if wif.private else None
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error
    return Source(
        wif.title or path.stem,
        factors,
        np.rint(wif.palette * (255 / wif.top)).astype(np.uint8),
        wif.warp_colours - 1,
        wif.weft_colours - 1,
        wif,
        (made, path.name) if made else None,
        str(path),
        wif.remarks,
    )


def _from_json(path: Path) -> tuple[Weave, str]:
    from sim_core.validation.files import read_json

    values = read_json(path, "a weave written as JSON")
    if not isinstance(values, dict):
        raise WeaveError(f"{path}: not an object – give what Weave.to_dict or draft_to_dict wrote")
    try:
        if "draft" in values:
            return Weave.from_dict(values), path.name
        return dressed(draft_from_dict(values)), ASSUMED
    except WeaveError as error:
        raise WeaveError(f"{path}: {error}") from error


def _ours(weave: Weave, origin: str) -> Source:
    palette, warp, weft = thread_colours(weave)
    return Source(
        weave.name,
        Factors.of_lift(weave.draft.lift),
        palette.astype(np.uint8),
        warp - 1,
        weft - 1,
        made=(weave, origin),
    )


def _structure(draft: Draft) -> Draft:
    """A draft without series that only colour its yarns: stripes are no larger repeat of the weave."""
    channels = draft.channels
    if channels.order is not None or channels.layer is not None:
        return draft
    return replace(draft, channels=replace(channels, end_series=None, pick_series=None))


def _woven(wif: Wif, name: str) -> tuple[Weave, str]:
    from sim_core.weave.files.wif.cloth import cloth_of, cut_to_repeat

    cut, note = cut_to_repeat(wif)
    picks, ends = cut.factors.loose()
    for what, loose in (("ends", ends), ("picks", picks)):
        if loose.size:
            raise WeaveError(
                f"{what} {listed(loose + 1)} never interlace – a yarn needs both warp and weft points"
            )
    weave, origin = cloth_of(cut, dressed(cut.draft), name, ASSUMED)
    return weave, origin + note
