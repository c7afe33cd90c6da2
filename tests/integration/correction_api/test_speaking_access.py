"""Speaking to the page, for everybody: axe-core looks at it while somebody speaks, has to choose,
and can take back what was done."""

import httpx
import pytest
from playwright.sync_api import expect

from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.test_access import SIZES, hushed, violations
from tests.integration.correction_api.test_speaking import ALLOW, differ, microphone

LASTING = """
const { setTimeout } = window;
window.setTimeout = (work, ms, ...rest) => setTimeout(work, ms >= 5000 ? 60 * ms : ms, ...rest);
"""
"""What goes by itself after seconds stays while axe looks, on a machine that is busy, too."""
STATES = {
    "listening": ".speak.listening .talk[aria-pressed=true]",
    "to choose from": ".choice + .choice",
    "to undo": ".undo",
}


@pytest.mark.parametrize("size", SIZES)
def test_axe_finds_nothing_while_one_speaks_and_chooses_and_when_one_can_undo(
    api: httpx.Client, robot: FakeRobot, size: str
) -> None:
    (width, height), options = SIZES[size]
    screen = {"viewport": {"width": width, "height": height}, **options}
    found: dict[str, list[str]] = {}
    with microphone(str(api.base_url), "plate", ALLOW, **screen) as page:
        page.add_init_script(LASTING)
        page.route("**/api/v1/speech*", differ)
        page.reload()
        robot.decide()
        expect(page.locator(".proposal")).to_have_count(len(COMMANDS))
        expect(page.locator("canvas.drawn")).to_have_count(2)
        expect(page.locator(".talk")).to_be_enabled()
        acts = (
            lambda: page.keyboard.down(" "),
            lambda: page.keyboard.up(" "),
            lambda: page.keyboard.press("2"),
        )
        for (state, shown), act in zip(STATES.items(), acts, strict=True):
            act()
            expect(page.locator(shown)).to_be_visible()
            found[state] = violations(page) + [f"speaks, too: {html}" for html in hushed(page)]
            expect(page.locator(shown)).to_be_visible()
    assert found == {state: [] for state in STATES}
