"""The pictures of the README, of a service that runs beside it, and the same pages at other sizes,
for whoever changes how they look.

`player` and `progress` while `hld up --oracle --rounds 3 --episodes 12 --evaluate 10` is in its
third round, `live` while `hld up` goes on with the same data in real time.
"""

import re
from pathlib import Path
from typing import Annotated

import httpx
import typer
from playwright.sync_api import Page, expect

from tests.integration.correction_api.browsing import (
    DESK,
    PHONE,
    SIDEWAYS,
    TABLET,
    launched,
    take_proposal,
)

EPISODES = "api/v1/episodes?corrected=true&success=true&task=sandwich&version=1.0&limit=1"
EPISODE_MS = 600_000  # On a busy machine.
BESIDE = Path("runs/screenshots")
EARLY = re.compile(r"^\d\d$")
NAMES = re.compile(r"sandwich(?: with|:) (?!everything)")
LEAVES_OUT = re.compile(r"\b(?:but|except|without|no|not|leave|leaving|hold|skip|minus)\b")
FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def live(page: Page) -> None:
    """A robot that obeys a person, who asks for something that the prompt names."""
    expect(page.locator("canvas.drawn").first).to_be_visible()
    step = page.locator(".focus .facts b").first
    while True:
        expect(step).to_have_text(EARLY, timeout=EPISODE_MS)  # Nothing is done yet.
        prompt = page.locator(".prompt").inner_text()
        if NAMES.search(prompt) and not LEAVES_OUT.search(prompt):
            break
        expect(step).not_to_have_text(EARLY, timeout=EPISODE_MS)
    take_proposal(page, fits=lambda text: text.startswith("pick") and text.split()[-1] in prompt)
    expect(page.locator(".who")).to_have_text("told by person")


def player(page: Page) -> None:
    """A decision at which a person spoke, and a stretch that somebody judges."""
    expect(page.locator(".timeline image").first).to_be_attached()
    for key in (".", ".", "."):
        page.keyboard.press(key)
    expect(page.locator("figure.still img")).to_have_count(2)


def progress(page: Page) -> None:
    """Curves and figures."""
    expect(page.locator(".curves canvas")).to_have_count(2)


def shoot(page: Page, name: str, out: Path, beside: Path) -> None:
    """Write out/NAME.jpg as on a desk, and beside/NAME-WIDTHxHEIGHT.jpg at three other sizes."""
    wanted = {DESK: out / f"{name}.jpg"}
    for width, height in (TABLET, PHONE, SIDEWAYS):
        wanted[width, height] = beside / f"{name}-{width}x{height}.jpg"
    for (width, height), path in wanted.items():
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_load_state("networkidle")
        page.evaluate(FRAMES)
        page.screenshot(path=path, type="jpeg", quality=76)


def main(
    names: Annotated[list[str], typer.Argument(help="live, player or progress")],
    url: Annotated[str, typer.Option(help="where the page is")] = "http://127.0.0.1:8000/",
    out: Annotated[Path, typer.Option(help="folder of the pictures")] = Path("docs"),
    beside: Annotated[Path, typer.Option(help="folder of the other sizes")] = BESIDE,
) -> None:
    """Write docs/NAME.jpg for each of them, and runs/screenshots/NAME-WIDTHxHEIGHT.jpg."""
    pages = {"live": ("", live), "progress": ("progress.html", progress)}
    if "player" in names:
        found = httpx.get(f"{url}{EPISODES}").raise_for_status().json()["episodes"]
        if not found:
            raise typer.BadParameter(
                "no corrected sandwich of version 1.0 that succeeded is kept there: the picture "
                "of the player is taken beside `hld up --oracle --rounds 3`, see this file's head"
            )
        pages["player"] = (f"episode.html?id={found[0]['id']}", player)
    with launched() as browser:
        for name in names:
            path, bring = pages[name]
            page = browser.new_page(
                viewport={"width": DESK[0], "height": DESK[1]}, reduced_motion="reduce"
            )
            page.goto(url + path)
            bring(page)
            shoot(page, name, out, beside)
            page.close()


if __name__ == "__main__":
    typer.run(main)
