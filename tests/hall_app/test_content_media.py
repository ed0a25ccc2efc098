"""The hall's own media: in tune, loud enough, as drawn, and the same on every run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hall_app.content.models import read_glb
from hall_app.media import (
    FALLING_GAUZE,
    FINENESS,
    HALL_PIECE,
    RADIUS,
    RATE,
    Interlacing,
    Touch,
    back_height,
    bar_notes,
    falling_gauze,
    mirror_glb,
    pattern_drawing,
    pluck,
    weave_drawing,
)

ASSETS = Path(__file__).parents[2] / "assets"


@pytest.mark.parametrize("pitch", [87.31, 130.81, 174.61, 261.63, 349.23, 698.46])
def test_strings_are_in_tune(pitch: float):
    note = pluck(pitch, 3.0, Touch(), np.random.default_rng(3))
    sound = note[int(0.3 * RATE) : int(2.3 * RATE)]
    spectrum = np.abs(np.fft.rfft(sound * np.hanning(len(sound)), 8 * len(sound)))
    frequency = np.fft.rfftfreq(8 * len(sound), 1 / RATE)
    near = (frequency > 0.92 * pitch) & (frequency < 1.08 * pitch)
    found = frequency[near][spectrum[near].argmax()]
    assert abs(1200 * np.log2(found / pitch)) < 2.5  # [cents], half of what a good ear tells apart


def test_a_note_dies_away():
    note = pluck(174.61, 3.5, Touch(), np.random.default_rng(3))
    loud = [np.sqrt(np.mean(note[int(t * RATE) : int((t + 0.2) * RATE)] ** 2)) for t in (0.0, 1.0, 2.0, 3.0)]
    assert all(later < earlier for earlier, later in zip(loud, loud[1:], strict=False))


def test_a_glide_begins_below_its_pitch():
    straight = pluck(220.0, 3.0, Touch(), np.random.default_rng(3))
    slid = pluck(220.0, 3.0, Touch(glide=2.0), np.random.default_rng(3))
    begin = slice(int(0.01 * RATE), int(0.06 * RATE))

    def crossings(sound: np.ndarray) -> int:
        return int(np.sum(np.diff(np.signbit(sound).astype(int)) != 0))

    assert crossings(slid[begin]) < crossings(straight[begin])
    assert len(slid) == len(straight)


def test_every_beat_of_the_pieces_is_written():
    for piece in (HALL_PIECE, FALLING_GAUZE):
        for bar in piece:
            assert len(bar.split()) == 4, bar
            assert bar_notes(bar, 0.0), bar


def test_music_is_the_same_every_time_and_fades_out():
    first, second = falling_gauze(), falling_gauze()
    assert np.array_equal(first, second)
    assert np.abs(first).max() == pytest.approx(0.7)
    assert np.abs(first[-RATE // 10 :]).max() < 0.005


def test_sounds_can_be_read_back_and_stay_small():
    av = pytest.importorskip("av", reason="the extra bake is not installed")
    files = [*ASSETS.glob("media/music.*"), *ASSETS.glob("exhibits/pibo/media/listening.*")]
    assert len(files) == 4
    assert sum(path.stat().st_size for path in ASSETS.glob("media/music.*")) <= 1_500_000
    for path in files:
        with av.open(str(path)) as container:
            seconds = container.duration / 1e6
            frame = next(container.decode(audio=0))
        assert frame.layout.name == "stereo"
        assert (60 < seconds < 90) if path.stem == "music" else (20 < seconds < 40)


def test_mirror_is_shipped_as_made():
    for name, fineness in FINENESS.items():
        path = ASSETS / f"exhibits/mirror/media/mirror_{name}.glb"
        made = mirror_glb(fineness)
        assert len(made) == path.stat().st_size
        info = read_glb(path)
        assert info.low[1] == pytest.approx(0.0, abs=1e-6)
        assert 0.5 < info.high[1] < 0.7


def test_back_of_the_mirror_has_sixteen_equal_arcs():
    angle = np.linspace(0, 2 * np.pi, 1600, endpoint=False)
    height = back_height(np.full(1600, 0.62 * RADIUS), angle)
    assert np.allclose(height, np.roll(height, 100))
    assert np.ptp(height) > 0.001


def test_weave_drawing_shows_the_draft():
    lift = np.array([[True, False], [False, True]])
    picture = weave_drawing(Interlacing(lift, (1.6e-4, 2.2e-4), (5e-5, 5e-5), ("#c4624f", "#c4624f")))
    pixels = np.asarray(picture.convert("L"))
    squares = [
        [pixels[70 + 480 - 30 - 60 * row, 70 + 30 + 60 * column] < 128 for column in range(8)]
        for row in range(8)
    ]
    assert np.array_equal(squares, np.tile(lift, (4, 4)))


def test_pattern_drawing_measures_what_it_is_given():
    small = pattern_drawing([np.array([[0, 0], [0.4, 0], [0.4, 2.4], [0, 2.4]])])
    other = pattern_drawing([np.array([[0, 0], [0.4, 0], [0.4, 2.3], [0, 2.3]])])
    assert small.size == other.size
    assert np.asarray(small).tobytes() != np.asarray(other).tobytes()
