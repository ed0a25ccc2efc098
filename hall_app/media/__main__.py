"""`python -m hall_app.media [FOLDER]`: make the hall's music, drawings and ready-made mirror again."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from hall_app.content.lookup import content_folder
from hall_app.media.make import make_media


def main() -> int:
    """Make the media, telling each step on standard error."""
    parser = argparse.ArgumentParser(prog="python -m hall_app.media", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, help="content folder, default ./assets")
    make_media(content_folder(parser.parse_args().folder), _tell)
    return 0


def _tell(fraction: float, label: str) -> None:
    sys.stderr.write(f"{100 * fraction:3.0f} % {label}\n")


if __name__ == "__main__":
    sys.exit(main())
