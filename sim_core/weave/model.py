"""The `Weave` value: a draft, its two yarns and the sett."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from sim_core.errors import WeaveError
from sim_core.weave.draft.draft import Channels, Draft
from sim_core.weave.draft.figured import Figure
from sim_core.weave.weave_file import read_weave_file
from sim_core.weave.yarn import Yarn

__all__ = ["Weave", "draft_from_dict", "draft_to_dict"]

MOST_PER_METRE = 1e6
EXTRA = 2  # of Channels.pick_kind


@dataclass(frozen=True)
class Weave:
    """A cloth on the loom: draft, warp and weft yarn, and how many of each lie side by side.

    ends_per_m, picks_per_m: [1/m].  friction: coefficient between two layers of the cloth.
    extra: yarn of the supplementary wefts of a brocade, None where there are none.
    warp_colours: sRGB of the warp series, weft_colours: of the weft regions or series; empty: the yarns' own colours.
    figure: the recipe by which the draft was made; such a cloth is relaxed and drawn by its `cells`.
    Raises WeaveError where the sett is not positive, or a yarn of the ground never interlaces.
    """

    name: str
    draft: Draft
    warp: Yarn
    weft: Yarn
    ends_per_m: float
    picks_per_m: float
    friction: float = 0.3
    extra: Yarn | None = None
    warp_colours: tuple[tuple[float, float, float], ...] = ()
    weft_colours: tuple[tuple[float, float, float], ...] = ()
    figure: Figure | None = None

    def __post_init__(self) -> None:
        for key in ("ends_per_m", "picks_per_m"):
            value = getattr(self, key)
            if not 1 <= value <= MOST_PER_METRE:
                raise WeaveError(
                    f"weave {self.name}: {key} is {value} – give 1 to {MOST_PER_METRE:g} yarns per metre"
                )
        loose = self.draft.loose()
        if loose:
            raise WeaveError(
                f"draft {self.draft.name}: {loose} never interlaces – it needs both warp and weft points"
            )
        for key in ("warp_colours", "weft_colours"):
            colours = tuple(tuple(float(c) for c in colour) for colour in getattr(self, key))
            if not all(len(colour) == 3 and all(0 <= c <= 1 for c in colour) for colour in colours):
                raise WeaveError(
                    f"weave {self.name}: {key} – give three sRGB values between 0 and 1 a colour"
                )
            object.__setattr__(self, key, colours)
        if not 0 <= self.friction <= 2:
            raise WeaveError(f"weave {self.name}: friction is {self.friction} – between 0 and 2")

    @property
    def end_spacing(self) -> float:
        """Distance of neighbouring warp ends [m]."""
        return 1 / self.ends_per_m

    @property
    def pick_spacing(self) -> float:
        """Distance of neighbouring weft picks [m]."""
        return 1 / self.picks_per_m

    @property
    def openness(self) -> float:
        """Open fraction of the area: (1 - warp width x ends) (1 - weft width x picks), 0 where yarns touch."""
        warp = min(1.0, self.warp.width * self.ends_per_m)
        weft = min(1.0, self.weft.width * self.picks_per_m)
        return (1 - warp) * (1 - weft)

    @property
    def several(self) -> bool:
        """Whether it is woven of yarns of several colours."""
        return max(len(set(self.warp_colours)), len(set(self.weft_colours))) > 1

    @property
    def closeness(self) -> tuple[float, float]:
        """Width of a warp and of a weft yarn where it is widest, in its spacing: cloths are closed where one is 1.

        Filaments spread on floats; yarns of a compound unit share one place, extra picks lie between the ground's.
        """
        channels, counts = self.draft.channels, list(self.draft.lift.shape[::-1])
        if channels.pick_kind is not None and channels.layer is None:
            counts[1] = int((channels.pick_kind != EXTRA).sum())
        if channels.layer is not None:
            for axis, series in ((0, channels.end_series), (1, channels.pick_series)):
                counts[axis] //= 1 if series is None else 1 + int(series.max())
        floats = self.draft.interlacings()
        found = []
        for axis, (yarn, side) in enumerate(((self.warp, self.size[0]), (self.weft, self.size[1]))):
            over = self.draft.lift.shape[axis]
            spread = yarn.spread if int(floats[axis].min()) < over else 0.0
            found.append(yarn.width * (1 + spread) * counts[axis] / side)
        return found[0], found[1]

    @property
    def size(self) -> tuple[float, float]:
        """Width (along the weft) and height (along the warp) of one repeat [m]."""
        return self.draft.ends * self.end_spacing, self.draft.picks * self.pick_spacing

    @property
    def numbers(self) -> np.ndarray | None:
        """Which cell lies at each crossing, (picks, ends) int8; None where there is no figure."""
        return self.figure.numbers(self.ends_per_m, self.picks_per_m) if self.figure else None

    @cached_property
    def cells(self) -> tuple[Weave, ...]:
        """The small weaves that a figured one is made of, by number; a weave without a figure is its own."""
        numbers = self.numbers
        if self.figure is None or numbers is None:
            return (self,)
        drafts = self.figure.cells(1 + int(numbers.max()))
        return tuple(
            replace(self, name=f"{self.name} {k}", draft=draft, figure=None) for k, draft in enumerate(drafts)
        )

    @classmethod
    def load(cls, path: str | Path) -> Weave:
        """Read a weave file (TOML); raises FileProblem or WeaveError naming file, key, value and remedy.

        A file that says `sheer = false` means a cloth that nobody sees through: its yarns have to touch one way.
        """
        values = read_weave_file(Path(path))
        sheer = values.pop("sheer")
        try:
            weave = cls(**values)
            if sheer is False:
                weave._check_closed()
        except WeaveError as error:
            raise WeaveError(f"{path}: {error}") from error
        return weave

    def _check_closed(self) -> None:
        close, channels = self.closeness, self.draft.channels
        if channels.order is not None and channels.layer is None:
            raise WeaveError("sheer = false, but a leno holds its yarns apart – write sheer = true")
        if (
            max(close) >= 1 or channels.layer is not None
        ):  # hidden yarns of a compound fill what gaps there are
            return
        lacking = [
            f"the {name} is {share:.0%} of its spacing wide"
            for name, share in zip(("warp", "weft"), close, strict=True)
        ]
        raise WeaveError(
            f"sheer = false, but its yarns cannot touch: {' and '.join(lacking)} – flatten one by "
            f"{1 / max(close) ** 2:.1f} times more, set more yarns, or write sheer = true"
        )

    @cached_property
    def key(self) -> str:
        """Equal for equal weaves."""
        return json.dumps(self.to_dict(), sort_keys=True)

    def to_dict(self) -> dict:
        """A plain dictionary that JSON can hold and `from_dict` reads back."""
        values = {key: getattr(self, key) for key in ("name", "ends_per_m", "picks_per_m", "friction")}
        if self.figure:
            values["figure"] = self.figure.to_dict()
        else:
            values["draft"] = draft_to_dict(self.draft)
        values |= {"warp": asdict(self.warp), "weft": asdict(self.weft)}
        if self.extra:
            values["extra"] = asdict(self.extra)
        for key in ("warp_colours", "weft_colours"):
            if getattr(self, key):
                values[key] = [list(colour) for colour in getattr(self, key)]
        return values

    @classmethod
    def from_dict(cls, values: dict) -> Weave:
        """The inverse of `to_dict`; raises WeaveError for a missing or unknown key."""
        try:
            rest = dict(values)
            if "figure" in rest:
                rest["figure"] = figure = Figure(**rest["figure"])
                sett = float(rest["ends_per_m"]), float(rest["picks_per_m"])
                draft = figure.draft(figure.numbers(*sett), str(rest["name"]))
            else:
                draft = draft_from_dict(rest.pop("draft"))
            yarns = {side: Yarn(**rest.pop(side)) for side in ("warp", "weft", "extra") if side in rest}
            return cls(draft=draft, **yarns, **rest)
        except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
            if isinstance(error, WeaveError):
                raise
            raise WeaveError(
                f"weave: {error} – the dictionary must be one that Weave.to_dict wrote"
            ) from error


def draft_to_dict(draft: Draft) -> dict:
    """Name, lift and channels of a draft as JSON can hold them."""
    values = {"name": draft.name, "lift": draft.lift.astype(int).tolist()}
    channels = {name: channel.tolist() for name, channel in draft.channels.items()}
    return values | ({"channels": channels} if channels else {})


def draft_from_dict(values: dict) -> Draft:
    """The inverse of `draft_to_dict`; raises WeaveError for what is no draft."""
    try:
        channels = {name: np.array(channel) for name, channel in values.get("channels", {}).items()}
        return Draft(str(values["name"]), np.array(values["lift"]), Channels(**channels))
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
        if isinstance(error, WeaveError):
            raise
        raise WeaveError(f"draft: {error} – the dictionary must hold name, lift and channels") from error
