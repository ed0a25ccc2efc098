"""The sections of the research page: their words, their files, and the figures that matter most, read from these."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "docs" / "figures"
GARMENTS = {
    "beizi": ("褙子", "beizi"),
    "song-daxiushan": ("大袖衫", "robe of large sleeves"),
    "tang-ruqun": ("齐胸襦裙", "skirt tied above the breast"),
    "ming-mamian": ("袄与马面裙", "coat over a mamian skirt"),
    "ming-yuanling": ("圆领袍", "round-collared robe"),
    "walking": ("行走的褙子", "coat that walks"),
    "zhiju": ("直裾", "robe on a T-bar"),
    "pibo-figure": ("披帛与袍", "pibo over a robe"),
    "pibo": ("披帛", "scarf"),
    "gown": ("襌衣", "gauze gown"),
}

OURS = "the bake's"  # as docs/figures/light.json names it

Words = dict[str, str]
Rows = list[tuple[Words, str | Words]]


@dataclass(frozen=True)
class Section:
    """files: of docs/figures, without .json; plot_alt: what its plot shows, where it has one."""

    id: str
    title: Words
    about: Words
    commands: tuple[str, ...]
    figures: Callable[[], Rows]
    files: list[str] = field(default_factory=list)
    plot_alt: Words | None = None

    def date(self) -> str:
        """Of a section without files: when the garments or the room were baked last."""
        place = "assets/room/room.json" if self.id == "light" else "assets/exhibits"
        told = subprocess.run(
            ("git", "log", "-1", "--format=%cs", "--", place),
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        return told.stdout.strip()


def read(name: str):
    return json.loads((FIGURES / f"{name}.json").read_text("utf-8"))


def both(zh: str, en: str) -> Words:
    return {"zh": zh, "en": en}


def bake(exhibit: str) -> dict:
    """The record of a bake, its errors those of the garment that is shown, not of its belt."""
    record = json.loads((ROOT / f"assets/exhibits/{exhibit}/baked/bake.json").read_text("utf-8"))
    before, errors = f"{record.get('shown')}_", record["errors"]
    own = {name.removeprefix(before): value for name, value in errors.items() if name.startswith(before)}
    return record | {"errors": own or errors}


def walking() -> Rows:
    found = read("walking")
    moves, walks = found["moves"], found["walks"]
    grid = next(row for row in found["grids"] if row["cell_m"] == 0.04)
    return [
        (both("随机移动的次数", "Random moves"), f"{sum(row['moves'] for row in moves):,}"),
        (both("穿入障碍的次数", "Penetrations of obstacles"), str(sum(row["penetrations"] for row in moves))),
        (
            both("离障碍最近（毫米）", "Nearest to an obstacle [mm]"),
            f"{min(row['least_room_mm'] for row in moves):.1f}",
        ),
        (
            both(
                "同一输入，画面与服务器最多相差（毫米）", "Same input, display against server, at most [mm]"
            ),
            f"{max(row['miss_largest_mm'] for row in walks):.1f}",
        ),
        (
            both("贴着墙角走，差之中位数（毫米）", "Held against corners, median [mm]"),
            f"{grid['miss_median_mm']:.2f}",
        ),
    ]


def crowd() -> Rows:
    found = read("crowd")
    waves, attacks = found["here"]["waves"], found["here"]["attacks"]
    longest = max(row["walk_longer_ms"] for row in attacks if row["walk_longer_ms"] is not None)
    return [
        (both("同时在厅中的来客", "Visitors inside at once"), str(found["visitors"])),
        (
            both("按键到回答，95 % 分位（毫秒）", "From input to answer, p95 [ms]"),
            f"{max(row['walk_ms']['p95'] for row in waves):.1f}",
        ),
        (both("占用一核的", "Share of one core"), f"{max(row['cpu_share'] for row in waves):.0%}"),
        (both("内存最多（MB）", "Memory at most [MB]"), f"{max(row['most_mb'] for row in waves):.0f}"),
        (
            both("一个攻击者使别人的回答变慢，95 % 分位（毫秒）", "One attacker delays others, p95 [ms]"),
            f"{longest:.1f}",
        ),
    ]


def page() -> Rows:
    found = read("page")["summary"]
    return [
        (
            both("初次打开到全部画出（秒）", "Cold load until all is drawn [s]"),
            f"{found['load_s']['median']:.1f}",
        ),
        (both("首个画面的字节（MB）", "Bytes to the first view [MB]"), f"{found['megabytes']['median']:.1f}"),
        (both("行走时每帧（毫秒）", "A frame while walking [ms]"), f"{found['frame_ms']['median']:.0f}"),
        (
            both("近观展品（秒）", "Close-up of an exhibit [s]"),
            " / ".join(f"{row['median']:.1f}" for row in found["closeup_s"].values()),
        ),
    ]


def look() -> Rows:
    found = read("look")["summary"]
    names = {
        "shipped": ("烘焙的光", "the baked light"),
        "ambient": ("只有环境光", "one ambient light alone"),
        "beside": ("环境光与环境贴图", "ambient light and environment map"),
        "default": ("默认环境贴图", "the default environment map"),
    }
    return [
        (
            both(f"{zh}：入口 / 展品（毫秒）", f"{en}: entry / exhibit [ms]"),
            " / ".join(f"{v:.0f}" for v in found["cpu_ms"][key].values()),
        )
        for key, (zh, en) in names.items()
    ]


def mesh() -> Rows:
    found, polygons = read("mesh"), read("mesh-polygons")
    large = [r for r in found["growth"] if r["points"] > 900_000]
    ours = [r["seconds_median"] for r in large if r["engine"] == "growth"]
    triangle = [1 / r["ratio"] for r in large if r["engine"] == "Triangle p"]
    return [
        (
            both("一百万个点的三角化（秒）", "Triangulation of a million points [s]"),
            f"{min(ours):.2f}–{max(ours):.2f}",
        ),
        (
            both("与 Triangle 相比用时", "Time as a share of Triangle's"),
            f"{min(triangle):.2f}–{max(triangle):.2f}",
        ),
        (both("每点内存（字节）", "Memory a point [bytes]"), f"{found['memory']['bytes_a_point']:.0f}"),
        (
            both("随机多边形，坏网格", "Random polygons, bad meshes"),
            f"{polygons['polygons']:,}: {polygons['bad']}",
        ),
    ]


def weave() -> Rows:
    found = read("weave")
    near = [row for row in found["plain"] if row["p/d"] >= 2]
    return [
        (
            both("受力平衡对解析式的误差，最大", "Balance against closed forms, largest error"),
            f"{max(r['error'] for r in found['closed']):.0e}",
        ),
        (
            both("平纹的卷缩对弹性线，最大", "Crimp of tabby against the elastica, largest"),
            f"{max(abs(r['error']) for r in near):.1%}",
        ),
        (
            both("面密度对目录所载，各布之差", "Areal density against catalogues, each cloth"),
            ", ".join(f"{r['error']:+.1%}" for r in found["density"]),
        ),
    ]


def cloth() -> Rows:
    found, choose = read("cloth"), read("cloth-choose")
    lines: Rows = []
    names = {
        "hanging by an edge": "悬一边",
        "hanging by two corners": "悬两角",
        "flag": "旗",
        "teapot": "茶壶",
    }
    for scene, zh in names.items():
        row = found["time"][scene]["rows"][0]
        lines.append(
            (
                both(f"{zh}：每帧（毫秒），平均误差（毫米）", f"{scene}: a frame [ms], mean error [mm]"),
                f"{row['ms']:.1f}; {row['error_mm']['mean']:.4f}",
            )
        )
    kept = " / ".join(f"{row['kept']} : {row['of']}" for row in choose.values())
    lines.append((both("自选设置守住误差限", "Settings chosen by the program kept the limit"), kept))
    return lines


def learn() -> Rows:
    """Of each scene ours, the best beside it without a network, and the fine physics both are measured by."""
    lines: Rows = []
    names = {"flag": "旗", "teapot": "茶壶", "hanging": "悬布"}
    for scene, found in read("learn")["scenes"].items():
        rows = {name: row[0] for name, row in found["rows"].items()}
        plain = min(
            (rows[name] for name in ("linear", "biharmonic", "local_frames")), key=lambda r: r["mean_mm"]
        )
        figures = "; ".join(
            f"{row['mean_mm']:.2f} mm, {row['total_ms']:.0f} ms"
            for row in (rows["ours"], plain, rows["reference"])
        )
        lines.append(
            (
                both(
                    f"{names[scene]}：平均误差与每帧用时，学习所得、不学习者之最佳、细网格（半步长之差）",
                    f"{scene}: mean error, a frame; learned, the best without learning, fine (against half its step)",
                ),
                figures,
            )
        )
    return lines


def light() -> Rows:
    record, engines = (
        json.loads((ROOT / "assets/room/room.json").read_text("utf-8")),
        read("light")["engines"],
    )
    told = record["light"]
    return [
        (both("三角形", "Triangles"), f"{told['triangles']:,}"),
        (both("光照格", "Texels"), f"{told['texels']:,}"),
        (both("光线（百万）", "Rays [millions]"), f"{told['rays'] / 1e6:.0f}"),
        (both("用时（秒）", "Time [s]"), f"{told['seconds']:.0f}"),
        (both("噪声（标准差比均值）", "Noise (deviation over mean)"), f"{told['noise']:.1%}"),
        (
            both("射错的光线之比", "Share of wrong rays"),
            f"{max(row[OURS]['wrong'] for row in engines.values()):g}",
        ),
    ]


def survey() -> Rows:
    service, kernel = read("survey_service"), read("survey_r")
    largest = max(
        value
        for row in kernel["differences"].values()
        for key, value in row.items()
        if key in ("kmo", "chi2", "alpha", "eigenvalues")
    )
    return [
        (both("每秒提交", "Submissions a second"), f"{service['load']['per_second']:,.0f}"),
        (both("99 % 分位（毫秒）", "p99 [ms]"), f"{service['load']['p99_ms']:.0f}"),
        (
            both("写入中途杀掉：丢失 / 残缺", "Killed in mid-write: lost / partial"),
            f"{service['kills']['kills']}: {service['kills']['lost']} / {service['kills']['partial']}",
        ),
        (
            both("KMO、χ²、α、特征值与 R 相差，最大", "KMO, χ², α, eigenvalues against R, largest"),
            f"{largest:.0e}",
        ),
    ]


def garments() -> Rows:
    lines: Rows = []
    for exhibit, (zh, en) in GARMENTS.items():
        errors, seconds = bake(exhibit)["errors"], bake(exhibit)["seconds"]
        lines.append(
            (
                both(
                    f"{zh}：顶点，陷入身体的顶点，自交，垂挂用时",
                    f"{en}: vertices, of them inside the body, self-intersections, drape",
                ),
                f"{errors['vertices']:,}; {errors['inside_vertices']}; {errors['self_intersections']}; "
                f"{seconds['drape']:.0f} s",
            )
        )
    return lines


SECTIONS = (
    Section(
        "walking",
        both("漫游", "Walking"),
        both(
            "随机地走，看会不会穿墙；再看画面所示与服务器所算相差多少。",
            "Random walks, to see whether walls hold, and how far the display and the server lie apart.",
        ),
        ("hall bench walking",),
        walking,
        ["walking"],
        both(
            "横轴：距离网格的格长（米）；纵轴：画面与服务器之差的中位数与最大值（毫米）。",
            "Across: cell of the clearance grid [m]; up: display against server, median and largest [mm].",
        ),
    ),
    Section(
        "crowd",
        both("一百位来客与一个攻击者", "A hundred visitors, and one attacker"),
        both(
            "一个进程、一个核。攻击者全速发出各种请求时，其余三十人的回答变慢多少。",
            "One process on one core; how much later thirty others are answered beside one who sends at full speed.",
        ),
        ("hall bench crowd",),
        crowd,
        ["crowd"],
        both(
            "每一种攻击使别人按键到回答的 95 % 分位变慢的毫秒数。",
            "By how many milliseconds the p95 of others' answers grows, for each kind of attack.",
        ),
    ),
    Section(
        "page",
        both("网页", "The page"),
        both(
            "从打开到画出，从按键到镜头，从点击到近观。",
            "From opening to drawn, from key to camera, from click to close-up.",
        ),
        ("hall bench page",),
        page,
        ["page"],
        both(
            "各件展品自点击到近观画出的秒数，中位数与范围。",
            "Seconds from click to close-up of each exhibit, median and range.",
        ),
    ),
    Section(
        "look",
        both("光的代价", "What light costs"),
        both(
            "同一视角画一帧所用的处理器时间，与三种别的光照相比。",
            "Processor time of a picture of one view, beside three other ways to light it.",
        ),
        ("hall bench look",),
        look,
        ["look"],
        both(
            "四种光照下画一帧的毫秒数：入口与展品前。",
            "Milliseconds a picture under four kinds of light, at the entry and before an exhibit.",
        ),
    ),
    Section(
        "garments",
        both("展出的衣服", "The garments on show"),
        both(
            "每件衣服烘焙时量得的误差：陷入身体、自交、应变、轻模型的偏差。",
            "Errors measured while each garment was baked: what is inside the body, crossings, strain, deviation of "
            "the light model.",
        ),
        ("hall build -f", "hall check --garments"),
        garments,
        [],
        both(
            "展厅用的轻模型与模拟所得之差（毫米）：平均、99 % 分位、最大。",
            "Hall model against the simulated garment [mm]: mean, 99th percentile, largest.",
        ),
    ),
    Section(
        "weave",
        both("织物", "Weaving"),
        both(
            "由纱线受力平衡算出的布，与解析式、弹性线和目录所载相比。",
            "Cloth computed from the balance of its yarns, against closed forms, the elastica and catalogues.",
        ),
        ("simcore bench weave",),
        weave,
        ["weave", "drafts"],
        both(
            "横轴：秒；纵轴：卷缩的误差。两轴皆取对数。",
            "Across: seconds; up: error of the crimp; both logarithmic.",
        ),
    ),
    Section(
        "mesh",
        both("网格", "Meshing"),
        both(
            "把裁片划成三角形：快慢、大小与好坏，旁边是三个公开的程序。",
            "Panels divided into triangles: speed, size and quality, beside three public programs.",
        ),
        ("simcore bench mesh -- --peers --large", "python tests/mesh_polygons.py 10000"),
        mesh,
        ["mesh", "mesh-polygons"],
        both(
            "横轴：点数；纵轴：秒。两轴皆取对数，每种程序一列点。",
            "Across: points; up: seconds; both logarithmic, one row of points for each program.",
        ),
    ),
    Section(
        "cloth",
        both("布料", "Cloth"),
        both(
            "四个公开的场景，每帧用时与对细分极限的误差一起量。",
            "Four published scenes; time a frame and error against the refined limit, measured together.",
        ),
        ("simcore bench cloth", "simcore bench cloth -- --peers"),
        cloth,
        ["cloth", "cloth-choose", "cloth-peers"],
        both(
            "横轴：每帧毫秒；纵轴：离最细网格的平均距离（毫米）。两轴皆取对数。",
            "Across: milliseconds a frame; up: mean distance from the finest mesh [mm]; both logarithmic.",
        ),
    ),
    Section(
        "learn",
        both("学习所得的布", "Learned cloth"),
        both(
            "粗网格模拟，细褶由网络补上；只在没有学过的序列上量，与细网格相比。",
            "Simulated coarse, finer folds by a network; measured against fine cloth on sequences not learned from.",
        ),
        ("python tests/bench/bench_learn.py FOLDER --json docs/figures/learn.json",),
        learn,
        ["learn"],
        both(
            "横轴：每帧毫秒，含粗网格模拟；纵轴：平均误差（毫米）。两轴皆取对数。红为本馆所学，黄为模拟，蓝为其他。",
            "Across: milliseconds a frame, coarse physics included; up: mean error [mm]; both logarithmic. Red: ours, "
            "yellow: physics, blue: others.",
        ),
    ),
    Section(
        "light",
        both("展室的光", "Light of the room"),
        both(
            "烘焙光照所射的光线，与精确计算和另一程序相比。",
            "The rays of the baked light, against exact ones and another program.",
        ),
        ("hall build --room -f", "hall bench light"),
        light,
        ["light"],
        both(
            "各程序每秒射出的光线（百万）：寻最近处与只问遮挡。",
            "Millions of rays a second of each program: nearest hits, and whether anything blocks.",
        ),
    ),
    Section(
        "survey",
        both("问卷与统计", "Questionnaires and statistics"),
        both(
            "每秒收多少份、断电丢不丢、统计与 R 和 lavaan 相差多少。",
            "How many answers a second, whether a cut loses any, and statistics against R and lavaan.",
        ),
        ("survey bench",),
        survey,
        ["survey_service", "survey_analysis", "survey_r", "survey_lavaan"],
        both(
            "横轴：各组数据；纵轴：KMO、χ²、α 与特征值同 R 的相对差，取对数。",
            "Across: data sets; up: relative difference of KMO, χ², α and eigenvalues from R, logarithmic.",
        ),
    ),
)
