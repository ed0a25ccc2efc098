"""Pictures of the running hall: Enter screen, entry, every bay and exhibit, close-ups, panel, windows, form, phone.

python tests/bench/pictures.py [--content FOLDER] [--out docs/pictures] [--only NAME …] [--png]
python tests/bench/pictures.py --pairs CHECKOUT [--studies FOLDER] --out FOLDER
                                  ten views beside the same of an earlier hall, and of studies, for who does not know
                                  which is which
python tests/bench/pictures.py --tally FOLDER
                                  what readers of these pairs chose
"""

import argparse
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT))

from bench.browser import enter, open_browser, open_exhibit  # noqa: E402
from bench.picture_pairs import lay_pairs, tally  # noqa: E402
from running_hall import running_hall  # noqa: E402

DESK, PHONE = {"width": 1280, "height": 720}, {"width": 390, "height": 844}
STANDS = """
async () => {
  const scene = await (await fetch("/api/scene")).json();
  const {standBefore} = await import("/static/ui/map/geometry.js");
  const found = {};
  for (const {id, polygon} of scene.bays) {
    // From the bay's edge on the side of the entry, looking through it.
    const middle = [0, 1].map((k) => polygon.reduce((sum, corner) => sum + corner[k], 0) / polygon.length);
    const [dx, dz] = [middle[0] - scene.start.x, middle[1] - scene.start.z];
    const away = Math.hypot(dx, dz) || 1, back = Math.min(3.2, away);
    found[`bay-${id}`] = [middle[0] - (dx / away) * back, middle[1] - (dz / away) * back, Math.atan2(-dx, -dz), 0];
  }
  for (const exhibit of scene.exhibits) {
    const {x, z, yaw, pitch} = standBefore(exhibit, scene);
    found[`exhibit-${exhibit.id}`] = [x, z, yaw, pitch];
  }
  return {stands: found, exhibits: scene.exhibits.map(({id}) => id)};
}
"""


STILL = """() => document.getAnimations().every(
  (one) => one.playState !== "running" || one.effect.getTiming().iterations === Infinity)"""


@dataclass(frozen=True)
class Album:
    """Where pictures go, which are wanted (all when empty), and their format."""

    folder: Path
    only: tuple[str, ...]
    png: bool

    def wants(self, name: str) -> bool:
        return not self.only or any(name.startswith(wanted) for wanted in self.only)

    def shoot(self, page, name: str) -> None:
        if not self.wants(name):
            return
        page.wait_for_timeout(900)
        page.wait_for_function(STILL, timeout=30_000)
        file = self.folder / f"{name}.{'png' if self.png else 'jpg'}"
        page.screenshot(path=file, **({} if self.png else {"type": "jpeg", "quality": 84}))
        print(file, flush=True)


def new_page(browser, size: dict[str, int], *, touch: bool = False):
    page = browser.new_context(viewport=size, has_touch=touch).new_page()
    page.add_init_script("localStorage.setItem('hall.quality', 'high')")
    return page


def leave(page) -> None:
    page.keyboard.press("Escape")
    page.wait_for_timeout(500)


def enter_screens(browser, url: str, album: Album) -> None:
    for lang in ("zh", "en"):
        page = new_page(browser, DESK)
        page.goto(f"{url}/?lang={lang}")
        page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=120_000)
        album.shoot(page, f"enter-{lang}")
        page.context.close()


def hall(browser, url: str, album: Album) -> None:
    page = new_page(browser, DESK)
    enter(page, f"{url}/?lang=zh")
    album.shoot(page, "hall")
    found = page.evaluate(STANDS)
    for name, there in found["stands"].items():
        if album.wants(name):
            page.evaluate("(there) => hall.goTo(...there)", there)
            page.wait_for_timeout(1500)  # the glow of coming near
            album.shoot(page, name)
    for window in ("list", "settings", "help"):
        page.click(f"[data-testid={window}]")
        album.shoot(page, window)
        leave(page)
    for exhibit in found["exhibits"]:
        if album.wants(f"closeup-{exhibit}"):
            open_exhibit(page, exhibit)
            closeup(page, exhibit, album)
            leave(page)
    page.context.close()


def closeup(page, exhibit: str, album: Album) -> None:
    for lang in ("zh", "en"):
        page.click(f"[data-testid=lang-{lang}]")
        page.click("[data-testid=tab-intro]")
        album.shoot(page, f"closeup-{exhibit}-{lang}")
    page.mouse.move(420, 250)
    for _ in range(14):
        page.mouse.wheel(0, -120)
        page.wait_for_timeout(60)
    album.shoot(page, f"closeup-{exhibit}-near")


def form(browser, url: str, album: Album) -> None:
    page = new_page(browser, DESK)
    page.goto(f"{url}/questionnaires/garment?lang=en")
    album.shoot(page, "form")
    page.context.close()


def phone(browser, url: str, album: Album) -> None:
    page = new_page(browser, PHONE, touch=True)
    page.goto(f"{url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=120_000)
    album.shoot(page, "phone-enter")
    page.click("[data-testid=enter]")
    page.wait_for_function("() => hall.whole()", timeout=120_000)
    album.shoot(page, "phone-hall")
    found = page.evaluate(STANDS)
    exhibit = found["exhibits"][0]
    page.evaluate("(there) => hall.goTo(...there)", found["stands"][f"exhibit-{exhibit}"])
    page.wait_for_timeout(1500)
    album.shoot(page, "phone-near")
    open_exhibit(page, exhibit)
    album.shoot(page, "phone-closeup")
    page.context.close()


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--content", type=Path, default=ROOT / "assets")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures")
    parser.add_argument("--only", nargs="*", default=(), metavar="NAME", help="pictures whose names begin so")
    parser.add_argument("--png", action="store_true", help="lossless, for comparing")
    parser.add_argument(
        "--pairs", type=Path, metavar="CHECKOUT", help="of an earlier hall (git worktree add)"
    )
    parser.add_argument("--studies", type=Path, metavar="FOLDER", help="pictures of studies, for --pairs")
    parser.add_argument("--tally", type=Path, metavar="FOLDER", help="of pairs and choices-NAME.json")
    arguments = parser.parse_args()
    if arguments.tally:
        print(tally(arguments.tally))
        return 0
    if arguments.pairs:
        lay_pairs(arguments.content, arguments.pairs, arguments.studies, arguments.out)
        return 0
    arguments.out.mkdir(parents=True, exist_ok=True)
    album = Album(arguments.out, tuple(arguments.only), arguments.png)
    with (
        tempfile.TemporaryDirectory() as work,
        running_hall(arguments.content, Path(work)) as served,
        open_browser() as browser,
    ):
        parts = {"enter": enter_screens, "phone": phone, "form": form}
        for name, part in parts.items():
            if album.wants(name) or any(wanted.startswith(name) for wanted in album.only):
                part(browser, served.url, album)
        if not album.only or any(not wanted.startswith(tuple(parts)) for wanted in album.only):
            hall(browser, served.url, album)
    return 0


if __name__ == "__main__":
    sys.exit(main())
