"""Two short pieces for plucked strings on the five notes gong, shang, jue, zhi, yu; written for this hall."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hall_app.media.strings import RATE, Touch, harmonic, pluck, room, wooden

DEGREES = {"1": 0, "2": 2, "3": 4, "5": 7, "6": 9}  # gong mode, semitones over the key note
KEY = 174.61  # [Hz] F below middle C
SLIDES = {"/": 2.0, "\\": -2.0}

# Numbered notation, one bar of four beats a string, beats parted by blanks. "," and "'" an octave down or up;
# "/" slid up to, "\" slid down to; "~" swaying; "o" a flageolet; "-" rings on; "12" two notes in one beat.
HALL_PIECE = (
    "5,~ - 1 2",
    "3~ - 2 1",
    "6, 1 2~ -",
    "1 - - -",
    "3 5 /6~ -",
    "5 6 1' 6",
    "5~ - 3 2",
    "3~ - - -",
    "1'o 5o 3'o -",
    "2'o 6o 5'o -",
    "3'o 2'o 1'o 6o",
    "5o - - -",
    "6 1' \\6 5",
    "35 6 5~ 3",
    "2 3 56 5",
    "3~ - 2 1",
    "6, 5, 6, 1",
    "2~ - 3 2",
    "1 6, 1~ -",
    "5, - 1~ -",
)
HALL_BASS = tuple("1, . 5,, 5, 1, . 6,, 5, 1, . . 5, 6,, 1, 5,, 1, 6,, 5,, 1, 1,,".split())

FALLING_GAUZE = (
    "5' 3' 2' 1'",
    "6~ - 5 3",
    "56 5 3 2",
    "3~ - - -",
    "1'o 6o 5o 3o",
    "2 1 6, 5,",
    "6, 1~ - -",
    "1, - - -",
)
GAUZE_BASS = tuple("1, 6,, 5,, 1, 1, 5,, 6,, .".split())


def hall_music(seed: int = 7) -> np.ndarray:
    """The hall's piece, quiet enough to walk to: (N, 2) float64 in -1..1 at RATE."""
    return _played(HALL_PIECE, HALL_BASS, beat=0.86, seed=seed)


def falling_gauze(seed: int = 11) -> np.ndarray:
    """The scarf's piece: (N, 2) float64 in -1..1 at RATE."""
    return _played(FALLING_GAUZE, GAUZE_BASS, beat=0.72, seed=seed)


def _played(bars: Sequence[str], bass: Sequence[str], *, beat: float, seed: int) -> np.ndarray:
    random = np.random.default_rng(seed)
    notes = [note for number, bar in enumerate(bars) for note in bar_notes(bar, 4.0 * number)]
    low = [(4.0 * number, name) for number, name in enumerate(bass) if name != "."]
    out = np.zeros((int((4 * len(bars) * beat + 6.0) * RATE), 2))
    for start, name in low:
        touch = Touch(bright=0.2, pluck=0.3, ring=7.0)
        _lay(out, 0.4 + start * beat, pluck(_pitch(name), 5.5, touch, random), 0.34, -0.25)
    for start, name in notes:
        # Nobody plays like a clock: a few hundredths late or early, a little louder or softer.
        late, loud = 0.018 * random.standard_normal(), 1 + 0.12 * random.standard_normal()
        place = 0.35 * np.tanh(np.log2(_pitch(name) / KEY))
        _lay(out, 0.4 + start * beat + late, _sound(name, random), 0.3 * loud, float(place))
    out = room(wooden(out), random)
    fade = int(1.5 * RATE)
    out[-fade:] *= np.linspace(1, 0, fade)[:, None] ** 2
    return 0.7 * out / np.abs(out).max()


def bar_notes(bar: str, start: float) -> list[tuple[float, str]]:
    """(beat, name) of the notes of one bar; raises KeyError later for a name that is no degree."""
    notes = []
    for number, text in enumerate(bar.split()):
        names = _split(text)
        notes += [(start + number + k / len(names), name) for k, name in enumerate(names)]
    return notes


def _split(text: str) -> list[str]:
    """The notes within one beat: a note is a degree with its marks before ("/", "\\") and after."""
    names: list[str] = []
    before = ""
    for sign in text:
        if sign in SLIDES:
            before = sign
        elif sign in DEGREES:
            names.append(before + sign)
            before = ""
        elif names:
            names[-1] += sign
    return names


def _pitch(name: str) -> float:
    """Frequency [Hz] of a note's name."""
    degree = next(sign for sign in name if sign in DEGREES)
    octave = name.count("'") - name.count(",")
    return KEY * 2 ** (DEGREES[degree] / 12 + octave)


def _sound(name: str, random: np.random.Generator) -> np.ndarray:
    if "o" in name:
        return 0.62 * harmonic(2 * _pitch(name), 3.2)
    glide = next((step for sign, step in SLIDES.items() if sign in name), 0.0)
    touch = Touch(glide=glide, sway=0.28 if "~" in name else 0.0, bright=0.42)
    return pluck(_pitch(name), 3.8, touch, random)


def _lay(out: np.ndarray, start: float, note: np.ndarray, loud: float, place: float) -> None:
    """Add a note (N,) to `out` (M, 2); place: -1 left … 1 right."""
    begin = max(0, int(start * RATE))
    end = min(len(out), begin + len(note))
    angle = (place + 1) * np.pi / 4
    sides = np.array([np.cos(angle), np.sin(angle)])
    out[begin:end] += loud * note[: end - begin, None] * sides
