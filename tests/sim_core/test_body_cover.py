"""What a figure wears on its skin: a bodice and trousers that go with it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from sim_core.body import Cover, Figure, Loop, Mannequin, Petticoat, Pose, covered, load_motion, pose_named
from sim_core.body.motion import clearances
from sim_core.cloth.contact import field_of
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


def round_(x: np.ndarray) -> float:
    """How long [m] a tape measure round points (n, 2) is."""
    corners = x[ConvexHull(x).vertices]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).sum())


@pytest.mark.parametrize("cover", [Cover(), COVERS["both"]], ids=["bare", "covered"])
def test_a_petticoat_is_one_more_closed_surface(figure: Mannequin, cover: Cover) -> None:
    """As wide round its hem as told, its own mirror image, and no leg looks out of it; a folded one is slimmer."""
    before = covered(figure, cover) if cover != Cover() else figure
    worn = covered(figure, replace(cover, petticoat=Petticoat(BROWN, 1.4, 0.2)))
    count = len(before.vertices)
    np.testing.assert_array_equal(worn.vertices[:count], before.vertices)
    faces = worn.faces[len(before.faces) :] - count
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    own = worn.vertices[count:]
    places = np.round(1e6 * own).astype(int)
    assert np.array_equal(np.unique(places, axis=0), np.unique(places * [-1, 1, 1], axis=0))
    a, b, c = own[faces].transpose(1, 0, 2)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0  # wound outwards
    assert own[:, 1].min() == pytest.approx(0.2)
    assert round_(own[:, [0, 2]]) == pytest.approx(1.4, rel=0.02)  # a hand above its hem, which is rounded
    assert [piece.vertices.sum() for piece in worn.worn() if piece.name == "petticoat"] == [len(own)]
    assert len({len(piece.vertices) for piece in worn.worn()}) == 1
    posed = worn.posed(pose_named("display"))
    legs = posed[:count][before.trunk()]
    legs = legs[(legs[:, 1] > 0.22) & (legs[:, 1] < 0.6)]  # thighs may fill it
    assert field_of(posed[count:], faces, cell=0.02, band=0.1).solid().distance(legs).max() < -0.003
    narrow = worn.posed(Pose(spread=0.0))[count:]
    assert round_(narrow[:, [0, 2]]) < 0.8 * round_(before.vertices[before.trunk()][:, [0, 2]])
    half = worn.posed(Pose(spread=0.5))[count:]
    np.testing.assert_allclose(half, 0.5 * (narrow + own), atol=1e-9)
    assert worn.digest() != covered(figure, replace(cover, petticoat=Petticoat(BROWN, 1.5, 0.2))).digest()


def test_a_petticoat_is_spread_on_the_way_to_the_last_pose(tmp_path: Path) -> None:
    """Where a layer begins in a pose of its own; laid on the wearer as she stands it begins on the spread one."""
    path = tmp_path / "it.toml"
    layer = '[[layer]]\npattern = "patterns/qun.toml"\nweave = "weaves/juan.toml"\nPOSE[layer.place]\nway = "wrapped"\n'
    steps = '[[layer.step]]\ndo = "pose"\nseconds = 0.4\n'
    text = 'wearer = "mannequins/woman.npz"\npose = "display"\ncover = { petticoat = {} }\n' + layer + steps
    path.write_text(text.replace("POSE", 'start = "t"\n'), "utf-8")
    start = load_outfit(path, ASSETS).layers[0].program.start
    assert start is not None
    assert [start.towards(pose_named("display"), share).spread for share in (0.0, 0.25, 1.0)] == [
        0.0,
        0.25,
        1.0,
    ]
    path.write_text(text.replace("POSE", ""), "utf-8")
    stands = load_outfit(path, ASSETS)
    assert stands.layers[0].program.start is None
    assert stands.pose.spread == 1.0


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
        ("cover = {}", "cover: nothing of it is told – give bodice, trousers or petticoat"),
        ("cover = { petticoat = { girth = 0.6 } }", "cover.petticoat: girth: 0.6 m – the hips are 0.9"),
        ("cover = { petticoat = { hem = 0.8 } }", "cover.petticoat: hem: 0.8 m – the hips are 0.8"),
        ("cover = { petticoat = { wide = 1 } }", "cover.petticoat.wide"),
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
