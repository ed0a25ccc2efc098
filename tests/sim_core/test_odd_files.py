"""Odd and hostile files: every reader answers with one line that names the file, never with a traceback."""

import io
import json
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest

from sim_core.body import Mannequin
from sim_core.cloth.run import RunState, load_checkpoint, save_checkpoint
from sim_core.errors import FileProblem, OutlineError, SimCoreError
from sim_core.garment import Garment, Pattern
from sim_core.garment.pattern import measured
from sim_core.mesh.sheets import read_outline
from sim_core.validation import files as reading
from sim_core.weave import Weave

ASSETS = Path(__file__).parents[2] / "assets"
WOMAN = ASSETS / "mannequins" / "woman.npz"
GAUZE = (ASSETS / "weaves" / "gauze.toml").read_text("utf-8")
ROBE = (ASSETS / "patterns" / "robe.toml").read_text("utf-8")
PLAIN = 'name = "strip"\nedge = 0.05\nsize = [0.4, 2.4]\n'
SQUARE = '{"outline": [[0, 0], [1, 0], [1, 1], [0, 1]]}'

DIGITS = "1" * 5000
ODD_TEXT = {
    "thousands of digits": (f"x = {DIGITS}", "not valid"),
    "thousands of brackets": ("x = " + "[" * 5000 + "]" * 5000, "nested"),
    "thousands of tables": ("x = " + "{a = " * 5000 + "1" + "}" * 5000, "nested"),
    "no UTF-8": (b"\xff\xfe\x00", "not valid"),
    "a zero byte": (b"name = \x00", "not valid"),
    "only a mark": (b"\xef\xbb\xbf \n", "empty"),
}


def one_line(error: Exception, path: Path) -> str:
    text = str(error)
    assert text.startswith(str(path))
    assert text.count(str(path)) == 1
    assert "\n" not in text
    assert len(text) < len(str(path)) + 400
    return text


@pytest.mark.parametrize("load", [Weave.load, Pattern.load])
@pytest.mark.parametrize("kind", ODD_TEXT)
def test_toml_that_breaks_a_parser(tmp_path: Path, load, kind: str) -> None:
    path, (text, word) = tmp_path / "odd.toml", ODD_TEXT[kind]
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FileProblem) as caught:
        load(path)
    assert word in one_line(caught.value, path)


@pytest.mark.parametrize("load", [Weave.load, Pattern.load, read_outline, Garment.load, Mannequin.load])
def test_places_that_are_no_file(tmp_path: Path, load) -> None:
    for path in (tmp_path, tmp_path / ("long" * 100), tmp_path / "none"):
        with pytest.raises(FileProblem) as caught:
            load(path)
        one_line(caught.value, path)


@pytest.mark.parametrize("load", [Weave.load, Pattern.load, read_outline])
def test_texts_too_large_are_not_read(tmp_path: Path, load, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "large"
    path.write_bytes(b"#" * 2_000_001)
    monkeypatch.setattr(reading, "LARGEST_TEXT", 2_000_000)
    with pytest.raises(FileProblem, match="larger than 2 MB"):
        load(path)


def test_a_byte_order_mark_is_no_mistake(tmp_path: Path) -> None:
    for name, text in (("weave.toml", GAUZE), ("pattern.toml", PLAIN), ("outline.json", SQUARE)):
        (tmp_path / name).write_text(text, "utf-8-sig")
    assert Weave.load(tmp_path / "weave.toml") == Weave.load(ASSETS / "weaves" / "gauze.toml")
    assert Pattern.load(tmp_path / "pattern.toml").name == "strip"
    assert read_outline(tmp_path / "outline.json")[0][1] == [1, 0]


ODD_WEAVES = {
    "ends": 'kind = "satin"\nends = 60000\nstep = 7',
    "step": f'kind = "satin"\nends = 8\nstep = {"9" * 400}',
    "up": 'kind = "twill"\nup = 60000\ndown = 1',
    "down": f'kind = "twill"\nup = 1\ndown = {"9" * 400}',
    "lift": f'kind = "lift"\nlift = ["{"10" * 3000}", "{"01" * 3000}"]',
}


@pytest.mark.parametrize("key", ODD_WEAVES)
def test_drafts_without_measure(tmp_path: Path, key: str) -> None:
    path = tmp_path / "odd.toml"
    path.write_text(GAUZE.replace('kind = "plain"', ODD_WEAVES[key]), "utf-8")
    with pytest.raises(SimCoreError, match=rf"draft\.\w+\.{key}") as caught:
        Weave.load(path)
    one_line(caught.value, path)


@pytest.mark.parametrize("value", ["1e300", "1e-300", "inf", "nan", "9" * 400, "-1", "true", '"6"', "[]"])
@pytest.mark.parametrize("key", ["ends_per_m", "picks_per_m", "tex", "diameter", "tension", "stiffness"])
def test_yarns_without_measure(tmp_path: Path, key: str, value: str) -> None:
    path = tmp_path / "odd.toml"
    lines = [line for line in GAUZE.splitlines() if not line.startswith(f"{key} ")]
    at = 1 if key.endswith("per_m") else lines.index("[warp]") + 1
    path.write_text("\n".join([*lines[:at], f"{key} = {value}", *lines[at:]]), "utf-8")
    if (key, value) == ("tension", "1e-300"):
        assert Weave.load(path).warp.tension == 1e-300  # as good as none
        return
    with pytest.raises(SimCoreError) as caught:
        Weave.load(path)
    assert key in one_line(caught.value, path)


ODD_PATTERNS = {
    "thin as a hair": ("outline = [[0, 0], [1000, 0], [1000, 0.0001], [0, 0.0001]]", "1000 m wide"),
    "a hair wide": ("size = [0.0001, 2.0]", "0.0001 m wide"),
    "in millimetres": ("outline = [[0, 0], [400, 0], [400, 2400], [0, 2400]]", "400 m wide"),
    "near infinity": ("outline = [[0, 0], [1e300, 0], [1e300, 1e300]]", "1e"),
    "beyond floats": (f"outline = [[0, 0], [{'9' * 400}, 0], [1, 1]]", "outline"),
    "not numbers": ("outline = [[0, 0], [nan, 0], [1, 1]]", "finite"),
    "too fine": ("size = [1.0, 2.0]\nedge = 1e-9", "edge 1e-09 m makes more than"),
    "no length": ("size = [1.0, 2.0]\nedge = 0", "edge"),
    "crosses": ("outline = [[0, 0], [1, 1], [1, 0], [0, 1]]", "outline: crosses"),
    "too many points": (f"outline = {[[0.0, 0.0]] * 5001}", "outline"),
}


@pytest.mark.parametrize("kind", ODD_PATTERNS)
def test_outlines_without_measure(tmp_path: Path, kind: str) -> None:
    path, (text, word) = tmp_path / "odd.toml", ODD_PATTERNS[kind]
    path.write_text(f'name = "odd"\n{text}\n' + ("" if "edge" in text else "edge = 0.05\n"), "utf-8")
    with pytest.raises(FileProblem) as caught:
        Pattern.load(path)
    assert word in one_line(caught.value, path)


ODD_CUTS = {
    "edge": ("edge = 0.", "edge = 1e-9 # 0.", "panel.body: edge 1e-09 m makes more than"),
    "huge measures": ("[measures]\n", '[measures]\nvast = 1e300\nvaster = "vast * vast"\n', "vaster"),
    "deep brackets": ("[measures]\n", f'[measures]\ndeep = "{"(" * 5000}1{")" * 5000}"\n', "measures.deep"),
    "many signs": ("[measures]\n", f'[measures]\nsigns = "{"-" * 399}1"\n', ""),
    "many digits": ("[measures]\n", f'[measures]\ndigits = "{"9" * 390}"\n', "measures.digits"),
    "an odd literal": ("[measures]\n", "[measures]\nodd = \"along('\\\\d')\"\n", "measures.odd"),
    "a zero in text": ("[measures]\n", '[measures]\nzero = "1 \\u0000"\n', "measures.zero"),
}


@pytest.mark.parametrize("kind", ODD_CUTS)
def test_cuts_without_measure(tmp_path: Path, kind: str) -> None:
    path, (old, new, word) = tmp_path / "odd.toml", ODD_CUTS[kind]
    assert old in ROBE
    path.write_text(ROBE.replace(old, new, 1), "utf-8")
    if not word:
        assert Pattern.load(path).panels  # signs are odd, and legal
        return
    with pytest.raises(FileProblem) as caught:
        Pattern.load(path)
    assert word in one_line(caught.value, path)


def test_measures_end_in_a_number_or_a_line() -> None:
    for text in ("-" * 399 + "x", "1+" * 199 + "y", "9" * 390, "min(" * 90 + "1" + ")" * 90, "\0", "a" * 401):
        with pytest.raises(ValueError, match="–") as caught:
            measured(text, {"x": float("inf"), "y": float("nan")})
        assert "\n" not in str(caught.value)


def test_a_pattern_that_a_garment_remembers_wrongly() -> None:
    for data in ({}, {"name": "x"}, {"name": "x", "outline": "abc", "edge": 1, "seams": 3}):
        with pytest.raises(SimCoreError, match="to_dict"):
            Pattern.from_dict(data)


@pytest.mark.parametrize(
    "outline",
    [
        "[" * 5000 + "]" * 5000,
        f"[[0, 0], [{'9' * 400}, 0], [1, 1]]",
        f"[[0, 0], [{'9' * 5000}, 0], [1, 1]]",
        "[[0, 0], [1e300, 0], [1e300, 1e300]]",
        "[[0, 0], [1e-200, 0], [1e-200, 1e-200]]",
        '[[0, 0], {"x": 1}, [1, 1]]',
        '[["a", "b"], ["c", "d"], ["e", "f"]]',
        "[null, null, null]",
        "[[0, 0], [1, 0], [NaN, 1]]",
        "[[[0, 0]]]",
    ],
)
def test_outlines_no_mesh_can_have(tmp_path: Path, outline: str) -> None:
    from sim_core.mesh import panel_mesh

    path = tmp_path / "odd.json"
    path.write_text(f'{{"outline": {outline}}}', "utf-8")
    with pytest.raises((FileProblem, OutlineError)) as caught:
        panel_mesh(read_outline(path)[0], edge=0.1)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


def test_meshes_beyond_measure_are_refused_before_any_work() -> None:
    from sim_core.mesh import panel_mesh

    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    for edge in (1e-300, 1e-7, 4e-4):
        with pytest.raises(OutlineError, match=r"more than 5000000 vertices – give at least 0\.00048"):
            panel_mesh(square, edge=edge)
    comb = [[0.0, 0.0], [1.0, 0.0]] + [[1.0 - k * 1e-4, 0.5 + 0.4 * (k % 2)] for k in range(9000)]
    with pytest.raises(OutlineError, match="more than 5000000 vertices"):
        panel_mesh(comb, edge=0.0006)  # its rectangle is small, its outline long


def npz(**arrays: object) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


def zipped(content: bytes, *, flag: int = 0, method: int | None = None) -> bytes:
    """A zip with one member whose header claims encryption (flag 1) or another compression."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as made:
        made.writestr("format.npy", content)
    data = bytearray(stream.getvalue())
    for signature, at_flag, at_method in ((b"PK\x03\x04", 6, 8), (b"PK\x01\x02", 8, 10)):
        place = data.index(signature)
        data[place + at_flag] |= flag
        if method is not None:
            data[place + at_method] = method
    return bytes(data)


def header_of(shape: str, dtype: str = "<f8") -> bytes:
    """An npy array that claims a shape it has no data for."""
    text = f"{{'descr': '{dtype}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()


def every(names: tuple[str, ...], content: bytes) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as made:
        for name in names:
            made.writestr(f"{name}.npy", content)
    return stream.getvalue()


NAMES = ("format", "name", "vertices", "faces", "heads", "weights", "marks", "mark_names", "header", "key")
ODD_ARRAYS = {
    "empty": b"",
    "text": b"hello",
    "one array": (lambda s: (np.save(s, np.zeros(3)), s.getvalue())[1])(io.BytesIO()),
    "a pickle": pickle.dumps({"format": 1}),
    "pickled arrays": npz(**{name: np.array([{}], object) for name in NAMES}),
    "strings": npz(**{name: np.array("x") for name in NAMES}),
    "nothing inside": npz(),
    "other arrays": npz(faces=np.zeros((1, 3), np.int32), positions=np.zeros((3, 3))),
    "encrypted": zipped(b"abc", flag=1),
    "unknown compression": zipped(b"abc", method=77),
    "without end": every(NAMES, header_of("(1000000000000,)")),
    "of odd shape": every(NAMES, header_of("(-1, 3)")),
    "no header": every(NAMES, b"\x93NUMPY\x01\x00\xff\xff{"),
    "deep header": every(NAMES, header_of("(" * 60 + ")" * 60)),
}


@pytest.mark.parametrize("load", [Garment.load, Mannequin.load])
@pytest.mark.parametrize("kind", ODD_ARRAYS)
def test_arrays_of_another_kind(tmp_path: Path, load, kind: str) -> None:
    path = tmp_path / "odd.npz"
    path.write_bytes(ODD_ARRAYS[kind])
    with pytest.raises(FileProblem) as caught:
        load(path)
    one_line(caught.value, path)


@pytest.mark.parametrize("kind", ODD_ARRAYS)
def test_a_checkpoint_of_another_kind_is_none(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "odd.npz"
    path.write_bytes(ODD_ARRAYS[kind])
    assert load_checkpoint(path, "x") is None


def test_files_cut_short_or_flipped_are_refused_or_right(tmp_path: Path) -> None:
    whole, path = WOMAN.read_bytes(), tmp_path / "cut.npz"
    for share in (0.01, 0.3, 0.7, 0.999):
        path.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(FileProblem) as caught:
            Mannequin.load(path)
        one_line(caught.value, path)
    rng = np.random.default_rng(4)
    for place in rng.integers(0, len(whole), 12):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 255]) + whole[place + 1 :])
        try:
            assert len(Mannequin.load(path).faces)
        except FileProblem as error:
            one_line(error, path)


def test_archives_that_would_fill_the_memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "LARGEST_ARRAYS", 1000)
    with pytest.raises(FileProblem, match="more than"):
        reading.read_npz(WOMAN, ("vertices",), "a mannequin", "make it")


@pytest.mark.parametrize(
    ("name", "change", "word"),
    [
        ("vertices", lambda a: a[:, :2], "shapes"),
        ("vertices", lambda a: a.astype(str), "vertices"),
        ("vertices", lambda a: a * 1000.0, "beyond"),
        ("vertices", lambda a: np.where(np.arange(len(a))[:, None] == 3, np.nan, a), "finite"),
        ("faces", lambda a: a.astype(np.int32) - 5, "faces"),
        ("faces", lambda a: a.astype(float), "faces"),
        ("faces", lambda a: a[:0], "faces"),
        ("faces", lambda a: a.astype(np.int64) + 5, "faces"),
        ("weights", lambda a: a * 0, "weights"),
        ("weights", lambda a: a.astype(float) - 1, "weights"),
        ("heads", lambda a: a[:3], "shapes"),
        ("heads", lambda a: a.astype(complex), "heads"),
        ("marks", lambda a: a[1:], "shapes"),
        ("skin", lambda a: np.array("leather"), "skin 'leather'"),
        ("mark_names", lambda a: np.char.add(a, "x"), "no mark"),
        ("mark_names", lambda a: np.arange(len(a)), "no mark"),
        ("format", lambda a: np.array([1, 1]), "another format"),
        ("format", lambda a: np.array("one"), "another format"),
        ("format", lambda a: np.array(1), "another format"),
    ],
)
def test_mannequins_no_robe_fits(tmp_path: Path, name: str, change, word: str) -> None:
    with np.load(WOMAN) as data:
        arrays = dict(data)
    path = tmp_path / "odd.npz"
    np.savez(path, **{**arrays, name: change(arrays[name])})
    with pytest.raises(FileProblem) as caught:
        Mannequin.load(path)
    assert word in one_line(caught.value, path)
    assert "simcore figure" in str(caught.value)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("panels", 5),
        ("panels", []),
        ("dyes", [["r", "g", "b"]]),
        ("dyes", [[0.1, 0.2]]),
        ("dyes", [[9.0, 0.2, 0.1]]),
        ("cut", "abc"),
        ("weave", None),
        ("provenance", [1]),
        ("material", 3.0),
        ("format", 1),
    ],
)
def test_garments_with_an_odd_header(tmp_path: Path, key: str, value: object) -> None:
    index = np.array([[0, 1, 2]], np.int32)
    made = Garment(
        "g", np.eye(3)[:, :2], index, np.arange(3, dtype=np.int32), np.zeros(1, np.int32), np.eye(3)
    )
    path = tmp_path / "odd.npz"
    made.save(path)
    with np.load(path) as data:
        arrays = dict(data)
    header = json.loads(arrays["header"].tobytes())
    arrays["header"] = np.frombuffer(json.dumps({**header, key: value}).encode(), np.uint8)
    np.savez(path, **arrays)
    with pytest.raises(FileProblem) as caught:
        Garment.load(path)
    one_line(caught.value, path)


def test_a_checkpoint_comes_back_whole(tmp_path: Path) -> None:
    x = np.arange(6.0).reshape(2, 3)
    state = RunState(x, -x, 3, 1e-4, 0.9, 1, 20, 2, 1.1, trace=[(1e-3, 2e-3)], film=[x.astype(np.float32)])
    state.mode = x.T.copy()
    save_checkpoint(tmp_path / "run", "key", state)
    assert load_checkpoint(tmp_path / "run", "other") is None
    again = load_checkpoint(tmp_path / "run", "key")
    assert again is not None
    assert (again.frame, again.last_step, again.safety, again.rollbacks, again.substeps) == (
        3,
        1e-4,
        0.9,
        1,
        20,
    )
    assert (again.fallbacks, again.stretch) == (2, 1.1)
    assert np.array_equal(again.mode, x.T)
    assert again.trace == state.trace
    assert np.array_equal(again.film[0], state.film[0])
    assert np.array_equal(again.velocities, -x)


def test_an_older_garment_is_told_as_such(tmp_path: Path) -> None:
    header = np.frombuffer(json.dumps({"format": 1, "name": "old"}).encode(), np.uint8)
    np.savez(tmp_path / "old.npz", header=header, rest=np.zeros((3, 2)))
    with pytest.raises(FileProblem, match="another format – bake"):
        Garment.load(tmp_path / "old.npz")
