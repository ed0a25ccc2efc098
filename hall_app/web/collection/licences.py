"""Licences as curators write them (SPDX's short names), and the addresses that stand for them elsewhere."""

from __future__ import annotations

import re

__all__ = ["licence_address"]

# Written with http, as IIIF, Europeana and rightsstatements.org have them: they are names, not links.
_PUBLIC_DOMAIN = {
    "CC0-1.0": "http://creativecommons.org/publicdomain/zero/1.0/",
    "PDM-1.0": "http://creativecommons.org/publicdomain/mark/1.0/",
}
_CREATIVE_COMMONS = re.compile(r"CC-(BY(?:-NC)?(?:-ND|-SA)?)-([1-4]\.[05])", re.IGNORECASE)
_ADDRESS = re.compile(
    r"https?://(creativecommons\.org/(?:licenses|publicdomain)/|rightsstatements\.org/vocab/)\S+"
)


def licence_address(licence: str) -> str | None:
    """The address of a Creative Commons licence or a rights statement, None for any other wording."""
    text = licence.strip()
    if _ADDRESS.fullmatch(text):
        return text.replace("https://", "http://", 1)
    if match := _CREATIVE_COMMONS.fullmatch(text):
        return f"http://creativecommons.org/licenses/{match[1].lower()}/{match[2]}/"
    return _PUBLIC_DOMAIN.get(text.upper())
