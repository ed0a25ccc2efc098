"""WIF files made and damaged at random, for the tests and the bench."""

import numpy as np

from sim_core.weave.draft import Harness
from sim_core.weave.files.wif import Wif, wif_text


def generated(rng: np.random.Generator) -> Wif:
    """A random value with everything a WIF file can say."""
    ends, picks, shafts, treadles = (int(n) for n in rng.integers((1, 1, 1, 1), (40, 40, 17, 25)))
    threading = np.zeros((ends, shafts), bool)
    threading[np.arange(ends), rng.integers(0, shafts, ends)] = True
    if rng.random() < 0.3:
        threading |= rng.random(threading.shape) < 0.1
    plan = bool(rng.random() < 0.4)
    if plan:
        tieup, treadling = np.eye(shafts, dtype=bool), rng.random((picks, shafts)) < 0.4
        treadling[0, 0] = True
    else:
        tieup, treadling = rng.random((shafts, treadles)) < 0.4, rng.random((picks, treadles)) < 0.2
    colours, top = int(rng.integers(2, 9)), int(rng.choice([255, 999]))

    def length():
        return float(f"{rng.random():.9f}") / 100 if rng.random() < 0.5 else None

    other = (
        (
            (
                "PRIVATE OTHER PROGRAM",
                (("Zoom", str(rng.integers(9))), ("a b", "x;y")),
            ),
        )
        if rng.random() < 0.3
        else ()
    )
    return Wif(
        f"draft {rng.integers(1000)}", Harness(threading, tieup, treadling), plan,
        rng.integers(0, top + 1, (colours, 3)), top, rng.integers(1, colours + 1, ends),
        rng.integers(1, colours + 1, picks), (length(), length()), (length(), length()),
        (("Author", f"weaver {rng.integers(9)}"),) if rng.random() < 0.5 else (),
        tuple(f"note; {k}" for k in range(rng.integers(0, 3))), other,
    )  # fmt: skip


def damaged(rng: np.random.Generator) -> str:
    """A good file with bytes changed, lines lost, doubled, swapped, numbers grown, or cut short."""
    text = wif_text(generated(rng))
    for _ in range(int(rng.integers(1, 6))):
        kind = int(rng.integers(0, 7))
        lines = text.split("\r\n")
        at = int(rng.integers(len(lines)))
        if kind == 0 and text:
            place = int(rng.integers(len(text)))
            text = text[:place] + chr(int(rng.integers(0, 0x250))) + text[place + 1 :]
        elif kind == 1:
            text = "\r\n".join(lines[:at] + lines[at + 1 :])
        elif kind == 2:
            text = "\r\n".join([*lines, lines[at]])
        elif kind == 3:
            other = int(rng.integers(len(lines)))
            lines[at], lines[other] = lines[other], lines[at]
            text = "\r\n".join(lines)
        elif kind == 4:
            key, _, _ = lines[at].partition("=")
            lines[at] = (
                f"{key}={rng.choice(['-1', '1e9', '99999999999', '0', '', '1,,2', 'true', '٣', '1/0', 'NaN'])}"
            )
            text = "\r\n".join(lines)
        elif kind == 5:
            text = text[: int(rng.integers(len(text) + 1))]
        else:
            lines[at] = "[" + lines[at]
            text = "\r\n".join(lines)
    return text
