"""Motion files: keyed poses or curves over a period, as data; every defect told with file, key, value and remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sim_core.body.motion.curves import ROOT, Curve
from sim_core.body.motion.keys import Motion
from sim_core.body.motion.loop import Key, Loop
from sim_core.body.motion.steps import Steps
from sim_core.body.pose import T_POSE, Pose, pose_named
from sim_core.errors import FileProblem, SimCoreError
from sim_core.validation.files import read_toml, shown

__all__ = ["load_motion"]

WHAT = "a motion file (TOML); it needs [[key]] tables of seconds and pose, or a period and [[curve]] tables"
LONGEST = 600.0  # [s] of a motion
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
PoseTable = str | dict[str, Any]
Words = dict[Literal["zh", "en"], str]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid")


class _KeyTable(_Table):
    seconds: Number = Field(gt=0, le=60, description="how long it takes to come to the pose")
    pose: PoseTable = Field(description="name of a pose, or { name, joints, shift }")
    early: Number = Field(
        0.0, ge=0, le=60, description="[s] by which its move begins before the last one ends"
    )


class _CurveTable(_Table):
    joint: str = Field(description=f"of the figure, without _l or _r both; or {ROOT}")
    axis: Literal["x", "y", "z"]
    at: list[Number] = Field(min_length=2, max_length=1000, description="per cent of the period")
    degrees: list[Number] | None = Field(None, max_length=1000, description="of a joint")
    metres: list[Number] | None = Field(None, max_length=1000, description=f"of {ROOT}")
    scale: Number = Field(1.0, ge=-10, le=10)
    offset: Number = Field(0.0, ge=-180, le=180)
    lag: Number = Field(
        0.5, ge=0, le=1, description="share of the period by which the right side comes later"
    )
    source: str = Field(min_length=3, max_length=400, description="where the values are from")


class _StepsTable(_Table):
    off: Number = Steps.off
    flat: tuple[Number, Number] = Steps.flat
    width: Number = Field(Steps.width, ge=0.0, le=1.0)
    lift: Number = Field(Steps.lift, ge=0.0, le=0.5)
    toe_out: Number = Field(Steps.toe_out, ge=-30, le=45)
    turn: Number = Field(0.0, ge=-120, le=120)


class _MotionTable(_Table):
    name: str | None = Field(None, min_length=1, max_length=80)
    title: Words = {}
    loop: bool = False
    period: Number | None = Field(None, ge=0.2, le=600, description="[s]")
    rounds: int = Field(1, strict=True, ge=1, le=100)
    lead: Number = Field(1.0, ge=0.04, le=60)
    pose: PoseTable | None = None
    steps: _StepsTable | None = None
    key: list[_KeyTable] = Field([], max_length=1000)
    curve: list[_CurveTable] = Field([], max_length=200)


def load_motion(path: Path) -> Motion | Loop:
    """The motion of a file: a `Loop` where it says `loop = true` or has curves, else a `Motion` gone through once.

    Raises FileProblem naming file, key, value and remedy.
    """
    path = Path(path)
    values = read_toml(path, WHAT)
    try:
        read = _MotionTable.model_validate(values)
    except ValidationError as error:
        raise FileProblem(f"{path}: {_first(error)}") from error
    return _Reader(path).motion(read)


class _Reader:
    """Turns the tables of one file into values, naming file and key in every error."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def motion(self, read: _MotionTable) -> Motion | Loop:
        if not read.key and not read.curve:
            raise self._wrong("key", "missing – give [[key]] tables of seconds and pose, or [[curve]] tables")
        if not read.loop and not read.curve:
            for name in ("period", "pose", "rounds", "lead", "steps"):
                if name in read.model_fields_set:
                    raise self._wrong(
                        name, "only a motion that repeats has one – add loop = true, or leave it out"
                    )
            for k, key in enumerate(read.key, 1):
                if key.early:
                    raise self._wrong(f"key.{k}.early", "only keys of a loop overlap – add loop = true")
            self._short("key", "its keys", sum(key.seconds for key in read.key))
            poses = [self._pose(f"key.{k}.pose", key.pose) for k, key in enumerate(read.key, 1)]
            return Motion(tuple((key.seconds, pose) for key, pose in zip(read.key, poses, strict=True)))
        if "loop" in read.model_fields_set and not read.loop:
            raise self._wrong("loop", "false, but curves repeat – write loop = true")
        return self._loop(read)

    def _loop(self, read: _MotionTable) -> Loop:
        keys = tuple(
            Key(key.seconds, self._pose(f"key.{k}.pose", key.pose), key.early)
            for k, key in enumerate(read.key, 1)
        )
        for k, key in enumerate(keys[1:], 2):
            if key.early > min(key.seconds, keys[k - 2].seconds):
                raise self._wrong(
                    f"key.{k}.early", f"{key.early:g} – at most the seconds of this key and of the one before"
                )
        whole = sum(key.seconds for key in keys) - sum(key.early for key in keys[1:])
        if keys and read.period is not None and abs(read.period - whole) > 1e-6:
            raise self._wrong("period", f"{read.period:g}, but the keys take {whole:g} s – leave it out")
        if not keys and read.period is None:
            raise self._wrong("period", "missing – give the seconds after which the curves repeat")
        self._short("rounds", f"{read.rounds} periods", read.rounds * (whole if keys else read.period or 0.0))
        base = keys[-1].pose if keys else T_POSE
        if read.pose is not None:
            if keys:
                raise self._wrong("pose", "the last key's pose is where the loop begins – leave it out")
            base = self._pose("pose", read.pose)
        curves = tuple(self._curve(f"curve.{k}", table) for k, table in enumerate(read.curve, 1))
        steps = None
        if read.steps is not None:
            steps = self._of("steps", Steps, **read.steps.model_dump())
        return self._of(
            "",
            Loop,
            name=read.name or self._path.stem,
            period=whole if keys else read.period,
            base=base,
            curves=curves,
            keys=keys,
            steps=steps,
            rounds=read.rounds,
            lead=read.lead,
            title={str(language): words for language, words in read.title.items()},
        )

    def _curve(self, key: str, table: _CurveTable) -> Curve:
        own, other = ("metres", "degrees") if table.joint == ROOT else ("degrees", "metres")
        values = getattr(table, own)
        if values is None or getattr(table, other) is not None:
            raise self._wrong(f"{key}.{own}", f"{table.joint} takes {own} – give them, and no {other}")
        return self._of(
            key,
            Curve,
            joint=table.joint,
            axis=table.axis,
            at=tuple(table.at),
            values=tuple(values),
            scale=table.scale,
            offset=table.offset,
            lag=table.lag,
            source=table.source,
        )

    def _pose(self, key: str, told: PoseTable) -> Pose:
        where = f"{self._path}: {key}"
        try:
            return pose_named(told, where) if isinstance(told, str) else Pose.of(told, where)
        except SimCoreError as error:
            raise FileProblem(str(error)) from error

    def _of(self, key: str, make: Any, **values: Any) -> Any:
        """What `make` makes; its errors told with file and key."""
        try:
            return make(**values)
        except SimCoreError as error:
            where = f"{key}." if key else ""
            raise FileProblem(f"{self._path}: {where}{error}") from error

    def _short(self, key: str, what: str, seconds: float) -> None:
        if seconds > LONGEST:
            raise self._wrong(key, f"{what} take {seconds:g} s – give a motion of {LONGEST:g} s at most")

    def _wrong(self, key: str, text: str) -> FileProblem:
        return FileProblem(f"{self._path}: {key}: {text}")


def _first(error: ValidationError) -> str:
    """The first problem of a file in one line: key, what, value."""
    first = error.errors()[0]
    key = ".".join(str(part + 1) if isinstance(part, int) else str(part) for part in first["loc"])
    if first["type"] == "extra_forbidden":
        return f"{key[:80]}: unknown key – remove it or correct its name (see `simcore motion --help`)"
    value = f" (found {shown(first['input'])})" if first["type"] != "missing" else ""
    return f"{key}: {first['msg'].removeprefix('Value error, ')}{value}"
