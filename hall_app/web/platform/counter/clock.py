"""Days and hours as pages tell them: on the house's own clock, and by which that is, for who reads them elsewhere."""

from __future__ import annotations

from datetime import UTC, date, datetime, timedelta

__all__ = ["clock_line", "told_day", "told_hours", "told_time"]

_WEEKDAYS = {"zh": "一二三四五六日", "en": ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")}
_TELLS = ("<time ", ' type="datetime-local"')  # in the HTML of a page that tells hours, or asks for them


def told_day(day: date, lang: str) -> str:
    """2026-11-28 and its weekday."""
    name = _WEEKDAYS[lang][day.weekday()]
    return f"{day:%Y-%m-%d} 周{name}" if lang == "zh" else f"{name} {day:%Y-%m-%d}"


def told_time(at: datetime, lang: str) -> str:
    """A moment, as a time element."""
    local = at.astimezone()
    return _element(local, f"{told_day(local, lang)} {local:%H:%M}") + _apart(local, lang)


def told_hours(begins: datetime, ends: datetime, lang: str) -> str:
    """From when to when on one day, which is told elsewhere."""
    hours = (_element(local, f"{local:%H:%M}") for local in (begins.astimezone(), ends.astimezone()))
    return "–".join(hours) + _apart(begins.astimezone(), lang)


def clock_line(page: str, lang: str) -> str:
    """A line that says by which clock a page tells its hours, "" where it tells none. page: its HTML."""
    if not any(mark in page for mark in _TELLS):
        return ""
    zone = _offset(datetime.now(UTC).astimezone())
    zh, en = (
        f"时间为本馆当地时间（现为 {zone}）。",
        f"All times are the house's local time (at present {zone}).",
    )
    return f'<p class="quiet">{zh if lang == "zh" else en}</p>'


def _element(local: datetime, told: str) -> str:
    return f'<time datetime="{local.isoformat(timespec="minutes")}">{told}</time>'


def _apart(local: datetime, lang: str) -> str:
    """The offset of a moment that has another than now: in summer, say, told in winter."""
    offset = _offset(local)
    if offset == _offset(datetime.now(UTC).astimezone()):
        return ""
    return f"（{offset}）" if lang == "zh" else f" ({offset})"


def _offset(local: datetime) -> str:
    """UTC+8, UTC+5:30, UTC−3, UTC."""
    minutes = (local.utcoffset() or timedelta()) // timedelta(minutes=1)
    hours, rest = divmod(abs(minutes), 60)
    sign = "−" if minutes < 0 else "+"
    return f"UTC{sign}{hours}{f':{rest:02}' if rest else ''}" if minutes else "UTC"
