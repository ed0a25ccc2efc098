"""The figures of the research page that matter most, section by section, read from what was measured."""

from __future__ import annotations

import json
import statistics
from pathlib import Path

import readme_learn
from signature import parts

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


def read(name: str):
    return json.loads((FIGURES / f"{name}.json").read_text("utf-8"))


def both(zh: str, en: str) -> Words:
    return {"zh": zh, "en": en}


def bake_record(exhibit: str) -> dict:
    return json.loads((ROOT / f"assets/exhibits/{exhibit}/baked/bake.json").read_text("utf-8"))


def bake(exhibit: str) -> dict:
    """The record of a bake, its errors those of the garment that is shown, not of its belt."""
    record = bake_record(exhibit)
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
    found, choose = read("cloth"), parts(read("cloth-choose"))
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
    """Of each scene: ours, the best beside it without a network, and the fine physics both are measured by."""
    lines: Rows = []
    names = {"flag": "旗", "teapot": "茶壶", "hanging": "悬布"}
    for scene, found in read("learn")["scenes"].items():
        mean = {
            name: {
                key: statistics.mean(row[key] for row in rows)
                for key in ("mean_mm", "hausdorff_mm", "total_ms")
            }
            for name, rows in found["rows"].items()
        }
        best = min(
            (name for name in readme_learn.PLAIN if name in mean), key=lambda name: mean[name]["mean_mm"]
        )
        kinds = (("ours", "学习所得", "learned"), (best, "不学习者之最佳", "best without a network"))
        kinds += (("reference", "细网格（步长减半）", "fine physics at half its step"),)
        for name, zh, en in kinds:
            row = mean[name]
            lines.append(
                (
                    both(
                        f"{names[scene]}，{zh}：平均误差；豪斯多夫距离；每帧",
                        f"{scene}, {en}: mean error; Hausdorff distance; a frame",
                    ),
                    f"{row['mean_mm']:.2f} mm; {row['hausdorff_mm']:.1f} mm; {row['total_ms']:.0f} ms",
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


def scan() -> Rows:
    lines: Rows = []
    for one in read("scan")["scans"]:
        for model, zh, en in (("close", "近观模型", "close-up"), ("hall", "展厅模型", "hall model")):
            lines.append(
                (
                    both(
                        f"{one['triangles']:,} 个三角形的扫描，{zh}：三角形；与扫描之差，99 % 分位",
                        f"scan of {one['triangles']:,} triangles, {en}: triangles; deviation, 99th percentile",
                    ),
                    f"{one[model]['triangles']:,}; {1000 * one[model]['deviation']['p99_m']:.2f} mm",
                )
            )
    return lines


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


def garment_records() -> dict:
    """What was measured while each garment was baked, to download."""
    kept = ("errors", "seconds", "stages", "layers", "versions", "hall_budget_m")
    return {exhibit: {key: bake_record(exhibit)[key] for key in kept} for exhibit in GARMENTS}


def room_record() -> dict:
    """What was measured while the room was raised and lit, to download."""
    record = json.loads((ROOT / "assets/room/room.json").read_text("utf-8"))
    return {key: record[key] for key in ("light", "triangles", "seconds", "cpu_seconds")}
