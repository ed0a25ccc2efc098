"""The README's pictures: Enter screen, hall, close-up, form, phone, taken from the running hall.

python tests/bench/pictures.py [--content FOLDER] [--out docs/pictures]
"""

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))
sys.path.insert(0, str(ROOT))

from bench.browser import enter, open_browser  # noqa: E402
from running_hall import running_hall  # noqa: E402

DESK, PHONE = {"width": 1280, "height": 720}, {"width": 390, "height": 800}


def shoot(page, out: Path, name: str) -> None:
    page.wait_for_timeout(900)
    page.screenshot(path=out / f"{name}.jpg", type="jpeg", quality=82)
    print(out / f"{name}.jpg", flush=True)


def stand(page, x: float, z: float, yaw: float) -> None:
    page.evaluate("([x, z, yaw]) => hall.goTo(x, z, yaw)", [x, z, yaw])
    page.wait_for_timeout(900)


def open_exhibit(page, exhibit: str, tab: str) -> None:
    page.click("[data-testid=list]")
    page.click(f"[data-testid=list-item-{exhibit}]")
    page.locator("html[data-closeup=drawn]").wait_for(state="attached", timeout=60_000)
    page.click(f"[data-testid=tab-{tab}]")


def desk(browser, url: str, out: Path) -> None:
    page = browser.new_page(viewport=DESK)
    page.goto(f"{url}/?lang=zh")
    page.locator("[data-testid=enter]:not([disabled])").wait_for(timeout=120_000)
    shoot(page, out, "enter")
    page.close()
    page = browser.new_page(viewport=DESK)
    enter(page, f"{url}/?lang=en")
    shoot(page, out, "hall")
    stand(page, 0.0, -3.4, 0.0)
    shoot(page, out, "near")
    stand(page, 3.0, -1.0, -1.0)
    shoot(page, out, "side")
    open_exhibit(page, "pibo", "intro")
    shoot(page, out, "closeup")
    page.mouse.move(420, 250)
    for _ in range(14):
        page.mouse.wheel(0, -120)
        page.wait_for_timeout(60)
    shoot(page, out, "closeup-near")
    page.keyboard.press("Escape")
    page.wait_for_timeout(500)
    open_exhibit(page, "mirror", "intro")
    shoot(page, out, "mirror")
    page.goto(f"{url}/questionnaires/garment?lang=en")
    shoot(page, out, "form")
    page.close()


def phone(browser, url: str, out: Path) -> None:
    context = browser.new_context(viewport=PHONE, has_touch=True)
    page = context.new_page()
    enter(page, f"{url}/?lang=zh")
    shoot(page, out, "phone")
    open_exhibit(page, "pibo", "intro")
    shoot(page, out, "phone-closeup")
    context.close()


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--content", type=Path, default=ROOT / "assets")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "pictures")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as work,
        running_hall(arguments.content, Path(work)) as hall,
        open_browser() as browser,
    ):
        desk(browser, hall.url, arguments.out)
        phone(browser, hall.url, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
