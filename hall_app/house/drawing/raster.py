"""A picture of pixels that is brought, decoded and drawn anew in sRGB: nothing of the file's own bytes is kept."""

from __future__ import annotations

import io
import warnings

from hall_app.content.models.pictures import in_eight_bits
from hall_app.house.people import PeopleError

__all__ = ["drawn_anew"]

_PIXELS = 60_000_000  # of a picture that is decoded
_EDGE = 3000  # [pixels] of a picture's longer side, as it is kept
_LINE_ART = 1_500_000  # [bytes] up to which a PNG stays one
_FORMATS = ("JPEG", "PNG", "WEBP", "TIFF")


def drawn_anew(name: str, data: bytes) -> tuple[bytes, str, str]:
    """(bytes, ending, what is known of it) of a picture drawn anew. name: for messages. Raises PeopleError."""
    from PIL import Image, ImageOps

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(data), formats=_FORMATS) as source:
                if source.width * source.height > _PIXELS:
                    raise PeopleError("file-pixels", name=name, most=_PIXELS // 1_000_000)
                line_art = source.format == "PNG"
                source.load()
                picture = _in_srgb(ImageOps.exif_transpose(source))
        picture.thumbnail((_EDGE, _EDGE))
        sheer = picture.mode == "RGBA"
        drawn, ending = io.BytesIO(), ".png"
        if line_art:
            picture.save(drawn, "PNG", optimize=True)
        if not line_art or drawn.tell() > _LINE_ART:
            drawn, ending = io.BytesIO(), ".webp" if sheer else ".jpg"
            picture.save(drawn, "WEBP" if sheer else "JPEG", quality=88)
    except PeopleError:
        raise
    except (Image.DecompressionBombWarning, Image.DecompressionBombError):
        raise PeopleError("file-pixels", name=name, most=_PIXELS // 1_000_000) from None
    except Exception as error:  # a decoder of foreign files may fail in any way
        raise PeopleError("file-broken", name=name, why=_first(error)) from None
    return drawn.getvalue(), ending, f"{picture.width} × {picture.height}"


def _in_srgb(source):
    """Colours as every browser shows them, without the file's own profile."""
    from PIL import Image, ImageCms

    mode = "RGBA" if source.mode in ("RGBA", "LA", "PA") or "transparency" in source.info else "RGB"
    profile, picture = source.info.get("icc_profile"), in_eight_bits(source).convert(mode)
    if profile and source.mode in ("RGB", "RGBA"):
        try:
            own = ImageCms.ImageCmsProfile(io.BytesIO(profile))
            srgb = ImageCms.createProfile("sRGB")
            picture = ImageCms.profileToProfile(picture, own, srgb, outputMode=mode) or picture
        except (ImageCms.PyCMSError, OSError, ValueError):
            pass  # a profile that nobody can read says nothing
    plain = Image.new(mode, picture.size)
    plain.paste(picture)
    return plain


def _first(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:120]
