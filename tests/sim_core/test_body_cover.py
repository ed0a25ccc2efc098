"""What a figure wears on its skin: a bodice and trousers that go with it."""

from pathlib import Path

import numpy as np
import pytest

from sim_core.body import Cover, Figure, Loop, Mannequin, covered, load_motion, pose_named
from sim_core.body.motion import clearances
from sim_core.errors import FileProblem
from sim_core.garment import load_outfit

ASSETS = Path(__file__).parents[2] / "assets"
RED, BROWN = (0.7, 0.2, 0.2), (0.45, 0.35, 0.25)
COVERS = {"both": Cover(RED, BROWN), "bodice": Cover(bodice=RED), "trousers": Cover(trousers=BROWN)}
OUTFIT = """\
wearer = "mannequins/woman.npz"
COVER
[[layer]]
pattern = "patterns/robe.toml"
weave = "weaves/juan.toml"
edge = 0.05
"""


@pytest.fixture(scope="module", params=["woman", "man-167"])
def figure(request: pytest.FixtureRequest) -> Mannequin:
    return Mannequin.load(ASSETS / "mannequins" / f"{request.param}.npz")


@pytest.mark.parametrize("name", COVERS)
def test_a_covered_figure_is_a_figure(figure: Mannequin, name: str) -> None:
    """Closed, its own mirror image, weights that sum to 1, and moved outwards alone."""
    worn = covered(figure, COVERS[name])
    edges = np.sort(np.stack([worn.faces, np.roll(worn.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    places = np.round(1e5 * worn.vertices).astype(int)
    assert np.array_equal(np.unique(places, axis=0), np.unique(places * [-1, 1, 1], axis=0))
    assert worn.weights.sum(1) == pytest.approx(1.0)
    assert worn.weights.min() >= 0.0
    assert np.array_equal(worn.heads, figure.heads)
    out = Figure(figure).field(pose_named("t")).solid().distance(worn.vertices)
    skin = Figure(figure).field(pose_named("t")).solid().distance(figure.vertices)
    assert out.min() > skin.min() - 1e-3  # a field of 8 mm is a little off, and cuts lie on what is round
    assert 0.0008 < out.max() < 0.04


@pytest.mark.parametrize("name", COVERS)
def test_pieces_have_level_edges(figure: Mannequin, name: str) -> None:
    """The edges of a piece are two heights of the T-pose, all round; no face is of two pieces."""
    worn = covered(figure, COVERS[name])
    assert {piece.name for piece in worn.worn()} - {"shoes"} == (
        {"bodice", "trousers"} if name == "both" else {name}
    )
    of = np.zeros(len(worn.faces), int)
    for piece in worn.worn():
        own = worn.faces[piece.vertices[worn.faces].all(1)]
        of += piece.vertices[worn.faces].all(1)
        if piece.name == "shoes":
            continue
        edges = np.sort(np.stack([own, np.roll(own, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
        ends, count = np.unique(edges, axis=0, return_counts=True)
        heights = worn.vertices[np.unique(ends[count == 1]), 1]
        high = heights > heights.mean()
        assert (
            max(np.ptp(heights[high]), np.ptp(heights[~high])) < 0.004
        )  # let out, an edge leans with the body
        assert heights[high].min() - heights[~high].max() > 0.2
    assert of.max() == 1


def test_trousers_leave_the_legs_room_to_walk(figure: Mannequin) -> None:
    walk = load_motion(ASSETS / "motions" / "walk.toml")
    assert isinstance(walk, Loop)
    worn = covered(figure, COVERS["both"])
    near = clearances(worn, walk.poses(worn, rate=25)[::14]).least
    assert near["left leg – right leg"] > 0.02
    assert Figure(worn, cell=0.02).field(pose_named("display")).values.min() < 0.0


def test_colours_are_part_of_what_a_figure_is(figure: Mannequin) -> None:
    red = covered(figure, COVERS["bodice"])
    assert red.digest() != covered(figure, Cover(bodice=BROWN)).digest()
    assert figure.digest() == Mannequin.load(ASSETS / "mannequins" / f"{figure.name}.npz").digest()


def outfit(folder: Path, cover: str):
    path = folder / "it.toml"
    path.write_text(OUTFIT.replace("COVER", cover), "utf-8")
    return load_outfit(path, ASSETS)


def test_an_outfit_names_the_cover(tmp_path: Path) -> None:
    wearer = outfit(tmp_path, 'cover = { bodice = "#ff0000", trousers = "#000000" }').wearer
    assert wearer is not None
    assert {piece.name: piece.dye for piece in wearer.pieces} == {"bodice": (1, 0, 0), "trousers": (0, 0, 0)}


@pytest.mark.parametrize(
    ("cover", "told"),
    [
        ("cover = {}", "cover: nothing of it has a colour – give bodice, trousers or both"),
        ('cover = { bodice = "red" }', "cover.bodice"),
        ('cover = { skirt = "#ff0000" }', "cover.skirt"),
    ],
)
def test_a_wrong_cover_is_told(tmp_path: Path, cover: str, told: str) -> None:
    with pytest.raises(FileProblem, match=told):
        outfit(tmp_path, cover)


def test_a_stand_wears_no_cover(tmp_path: Path) -> None:
    path = tmp_path / "it.toml"
    layer = '[[layer]]\npattern = "patterns/pibo.toml"\nweave = "weaves/gauze.toml"\n'
    path.write_text('[stand]\n[cover]\nbodice = "#ff0000"\n' + layer, "utf-8")
    with pytest.raises(FileProblem, match="cover: a stand has none"):
        load_outfit(path, ASSETS)
