"""The sections of the research page: their words, their files, and what of them is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import research_figures as figures
from research_figures import Rows, Words, both


@dataclass(frozen=True)
class Section:
    """files: of docs/figures, without .json; records: data that is gathered from the bakes; plot_alt: what its plot
    shows, where it has one; drawn: measured in a browser that draws."""

    id: str
    title: Words
    about: Words
    commands: tuple[str, ...]
    figures: Callable[[], Rows]
    files: list[str] = field(default_factory=list)
    plot_alt: Words | None = None
    records: dict[str, Callable[[], dict]] = field(default_factory=dict)
    drawn: bool = False


SECTIONS = (
    Section(
        "walking",
        both("漫游", "Walking"),
        both(
            "随机地走，看会不会穿墙；再看画面所示与服务器所算相差多少。",
            "Random walks, to see whether walls hold, and how far the display and the server lie apart.",
        ),
        ("hall bench walking",),
        figures.walking,
        ["walking"],
        both(
            "横轴：距离网格的格长（米）；纵轴：画面与服务器之差的中位数与最大值（毫米）。",
            "Across: cell of the clearance grid [m]; up: display against server, median and largest [mm].",
        ),
        drawn=True,
    ),
    Section(
        "crowd",
        both("一百位来客与一个攻击者", "A hundred visitors, and one attacker"),
        both(
            "一个进程、一个核。攻击者全速发出各种请求时，其余三十人的回答变慢多少。",
            "One process on one core; how much later thirty others are answered beside one who sends at full speed.",
        ),
        ("hall bench crowd",),
        figures.crowd,
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
        figures.page,
        ["page"],
        both(
            "各件展品自点击到近观画出的秒数，中位数与范围。",
            "Seconds from click to close-up of each exhibit, median and range.",
        ),
        drawn=True,
    ),
    Section(
        "look",
        both("光的代价", "What light costs"),
        both(
            "同一视角画一帧所用的处理器时间，与三种别的光照相比。",
            "Processor time of a picture of one view, beside three other ways to light it.",
        ),
        ("hall bench look",),
        figures.look,
        ["look"],
        both(
            "四种光照下画一帧的毫秒数：入口与展品前。",
            "Milliseconds a picture under four kinds of light, at the entry and before an exhibit.",
        ),
        drawn=True,
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
        figures.garments,
        [],
        both(
            "展厅用的轻模型与模拟所得之差（毫米）：平均、99 % 分位、最大。",
            "Hall model against the simulated garment [mm]: mean, 99th percentile, largest.",
        ),
        records={"garments": figures.garment_records},
    ),
    Section(
        "scan",
        both("扫描件", "Scans"),
        both(
            "把一件扫描件变成展厅与近观所用的模型：用时、内存、与扫描之差。",
            "A scan made into the models of hall and close-up: time, memory, and how far they are from the scan.",
        ),
        ("python tests/bench/bench_scan.py",),
        figures.scan,
        ["scan"],
        both(
            "两件扫描的近观与展厅模型同扫描之差（毫米）：平均、99 % 分位、最大。",
            "Close-up and hall model of two scans against the scan [mm]: mean, 99th percentile, largest.",
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
        figures.weave,
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
        figures.mesh,
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
        ("simcore bench cloth", "simcore bench cloth -- --peers", "python tests/bench/cloth_hard.py"),
        figures.cloth,
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
        figures.learn,
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
        figures.light,
        ["light"],
        both(
            "各程序每秒射出的光线（百万）：寻最近处与只问遮挡。",
            "Millions of rays a second of each program: nearest hits, and whether anything blocks.",
        ),
        records={"room": figures.room_record},
    ),
    Section(
        "survey",
        both("问卷与统计", "Questionnaires and statistics"),
        both(
            "每秒收多少份、断电丢不丢、统计与 R 和 lavaan 相差多少。",
            "How many answers a second, whether a cut loses any, and statistics against R and lavaan.",
        ),
        ("survey bench",),
        figures.survey,
        ["survey_service", "survey_analysis", "survey_r", "survey_lavaan"],
        both(
            "横轴：各组数据；纵轴：KMO、χ²、α 与特征值同 R 的相对差，取对数。",
            "Across: data sets; up: relative difference of KMO, χ², α and eigenvalues from R, logarithmic.",
        ),
    ),
)
