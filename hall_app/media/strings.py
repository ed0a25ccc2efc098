"""Plucked strings and the room they sound in: Karplus-Strong with glides, arrays in and arrays out.

Source of the string: K. Karplus, A. Strong, "Digital Synthesis of Plucked-String and Drum Timbres", 1983.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RATE = 48_000  # [1/s]


@dataclass(frozen=True)
class Touch:
    """How a string is played.

    bright: 0..1, share of high partials; pluck: place of the finger, share of the string; glide: semitones
    below the pitch from which the note slides up (negative: from above); sway: depth of the vibrato
    [semitones]; ring: time [s] in which a low note falls by 60 dB.
    """

    bright: float = 0.45
    pluck: float = 0.18
    glide: float = 0.0
    sway: float = 0.0
    ring: float = 6.0


def pluck(pitch: float, seconds: float, touch: Touch, random: np.random.Generator) -> np.ndarray:
    """One note: (N,) float64, about -1..1. pitch [Hz], seconds: how long it is kept."""
    bend = _bend(pitch, seconds, touch)
    raw = _string(pitch, int(np.ceil(bend[-1])) + 4, touch, random)
    # The string sounds at a whole-numbered period; reading it at a varying speed tunes and bends it.
    note = np.interp(bend, np.arange(len(raw)), raw)
    note *= np.minimum(1.0, np.arange(len(note)) / (0.002 * RATE))
    tail = min(len(note), int(0.25 * RATE))
    note[-tail:] *= np.cos(np.linspace(0, np.pi / 2, tail)) ** 2
    return note / max(np.abs(note).max(), 1e-9)


def _bend(pitch: float, seconds: float, touch: Touch) -> np.ndarray:
    """Reading positions (N,) [samples] in the raw string: tuning, slide and vibrato."""
    time = np.arange(int(seconds * RATE)) / RATE
    semitones = -touch.glide * np.exp(-time / 0.07)
    onset = np.clip((time - 0.35) / 0.5, 0.0, 1.0)
    semitones += touch.sway * onset * np.sin(2 * np.pi * 4.6 * time) * np.exp(-time / 1.8)
    period = round(RATE / pitch) + _blend(pitch, touch)  # the averaging delays by its own share of a sample
    return np.cumsum(pitch * period / RATE * 2 ** (semitones / 12))


def _blend(pitch: float, touch: Touch) -> float:
    """Share 0..1 of the neighbouring sample in the string's averaging: how fast high partials die."""
    return 0.5 * (1.05 - touch.bright) * min(1.0, 260 / pitch) ** 0.5


def _string(pitch: float, samples: int, touch: Touch, random: np.random.Generator) -> np.ndarray:
    """The raw string (samples,) at the whole-numbered period nearest to `pitch`."""
    period = round(RATE / pitch)
    burst = random.standard_normal(period)
    spectrum = np.fft.rfft(burst - burst.mean())
    partial = np.arange(len(spectrum))
    # A finger's flesh damps high partials; plucking at a share p of the length silences those with a node there.
    spectrum *= np.exp(-partial * (1.15 - touch.bright) / 9) * np.abs(np.sin(np.pi * partial * touch.pluck))
    start = np.fft.irfft(spectrum, period)
    loss = 10 ** (-3 * period / RATE / touch.ring)
    blend = _blend(pitch, touch)
    out = np.zeros(samples + period)
    out[:period] = start
    for begin in range(period, samples + 1, period):
        last = out[begin - period : begin]
        block = loss * ((1 - blend) * last + blend * np.roll(last, 1))
        end = min(begin + period, len(out))
        out[begin:end] = block[: end - begin]
    return out[:samples]


def harmonic(pitch: float, seconds: float) -> np.ndarray:
    """A flageolet note: few partials, bell-like; (N,) float64."""
    time = np.arange(int(seconds * RATE)) / RATE
    note = sum(
        share * np.sin(2 * np.pi * pitch * k * time) * np.exp(-time * k / 1.1)
        for k, share in ((1, 1.0), (2, 0.22), (3, 0.07))
    )
    note *= np.minimum(1.0, time / 0.004)
    tail = min(len(note), int(0.25 * RATE))
    note[-tail:] *= np.cos(np.linspace(0, np.pi / 2, tail)) ** 2
    return note


def room(
    dry: np.ndarray, random: np.random.Generator, *, seconds: float = 2.4, wet: float = 0.22
) -> np.ndarray:
    """`dry` (N, 2) with the echo of a wooden hall, (N, 2)."""
    from scipy.signal import butter, fftconvolve, sosfilt

    time = np.arange(int(seconds * RATE)) / RATE
    echo = random.standard_normal((len(time), 2)) * np.exp(-6.9 * time / seconds)[:, None]
    echo *= np.minimum(1.0, time / 0.03)[:, None]
    low = np.asarray(sosfilt(butter(2, 2600, fs=RATE, output="sos"), echo, axis=0))
    high = np.asarray(sosfilt(butter(1, 160, "high", fs=RATE, output="sos"), low, axis=0))
    high /= np.sqrt((high**2).sum(axis=0))
    return dry + wet * fftconvolve(dry, high, axes=0)[: len(dry)]


def wooden(dry: np.ndarray) -> np.ndarray:
    """`dry` (N, 2) through a hollow wooden body: three broad resonances, less above 5 kHz."""
    from scipy.signal import butter, iirpeak, lfilter, sosfilt

    out = dry.copy()
    for centre, width, share in ((110, 2.0, 0.5), (235, 2.5, 0.4), (520, 2.0, 0.25)):
        numerator, denominator = iirpeak(centre, width, fs=RATE)
        out += share * np.asarray(lfilter(numerator, denominator, dry, axis=0))
    return np.asarray(sosfilt(butter(2, 6500, fs=RATE, output="sos"), out, axis=0))
