"""What the keys of exhibit.toml are called on the office's pages."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["BEHAVIOUR_WORDS", "WORDS"]

WORDS: Mapping[str, tuple[str, str]] = {  # zh, en
    "title": ("名称", "Title"),
    "caption": ("一句话说明", "Caption"),
    "thumbnail": ("缩略图文件", "Thumbnail"),
    "questionnaire": ("问卷", "Questionnaire"),
    "licence": ("许可", "Licence"),
    "size_range": ("模型高度范围（米）", "Height of the model, least and most [m]"),
    "outfit": ("服装文件", "Outfit"),
    "scan": ("扫描文件", "Scan"),
    "motion": ("动作文件", "Motion"),
    "place.x": ("x：向右（米）", "x, to the right [m]"),
    "place.z": ("z：向入口（米）", "z, towards the entrance [m]"),
    "place.facing": ("朝向（度）", "Facing [degrees]"),
    "place.on": ("置于", "Stands on"),
    "place.lamp": ("射灯亮度（1 为常）", "Lamp, of the usual brightness"),
    "place.y": ("离地高度（米）", "Height of its foot [m]"),
    "body.shape": ("形状", "Shape"),
    "body.shape=round": ("圆形", "round"),
    "body.shape=box": ("方形", "box"),
    "body.radius": ("半径（米）", "Radius [m]"),
    "body.size": ("宽与深（米）", "Width and depth [m]"),
    "body.height": ("高（米）", "Height [m]"),
    "models.hall": ("展厅模型", "Model in the hall"),
    "models.close": ("近观模型", "Model of the close-up"),
    "show.nearest": ("最近观看距离（米）", "Nearest view [m]"),
    "show.hall_error_px": ("允许偏差（像素）", "Deviation in the hall [pixels]"),
    "show.hall_beneath_px": ("里层允许偏差（像素）", "The same of layers beneath [pixels]"),
    "record.object": ("品名", "Object"),
    "record.date": ("年代", "Date"),
    "record.culture": ("文化", "Culture"),
    "record.material": ("材质", "Material"),
    "record.technique": ("工艺", "Technique"),
    "record.colour": ("颜色", "Colour"),
    "record.measurements": ("尺寸", "Measurements"),
    "record.wear": ("穿法", "How it was worn"),
    "record.maker": ("制作者", "Maker"),
    "record.source": ("依据", "Source"),
    "record.rights": ("权利说明", "Rights"),
    "media.alt": ("画面描述", "What it shows"),
    "media.caption": ("图注", "Caption"),
    "media.transcript": ("文字稿", "Transcript"),
}

BEHAVIOUR_WORDS: Mapping[str, tuple[str, str]] = {
    "open_on_click": ("点击时打开", "Opens on a click"),
    "glow_when_near": ("走近时发光", "Glows when somebody is near"),
    "turn_slowly": ("缓慢转动", "Turns slowly"),
    "turn_to_visitor": ("转向观众", "Turns to its visitor"),
    "play_clip": ("播放影片", "Plays its film"),
}
