"""Labels of the catalogue record in both languages."""

RECORD_LABELS: dict[str, tuple[str, str]] = {
    "object": ("名称", "Object"),
    "date": ("年代", "Date"),
    "culture": ("文化", "Culture"),
    "material": ("材质", "Material"),
    "technique": ("工艺", "Technique"),
    "colour": ("颜色", "Colour"),
    "measurements": ("尺寸", "Measurements"),
    "wear": ("穿用", "How it is worn"),
    "maker": ("制作", "Maker"),
    "source": ("依据", "Basis"),
    "rights": ("权利", "Rights"),
}
