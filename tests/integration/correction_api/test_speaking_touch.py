"""Speaking to the page on a phone: a finger holds the button, and no button moves meanwhile."""

import httpx
import pytest
from playwright.sync_api import Page, expect

from shared.messages.correction import Kind
from tests.integration.correction_api.browsing import PHONE, SIDEWAYS
from tests.integration.correction_api.fakes import COMMANDS, FakeRobot
from tests.integration.correction_api.running import eventually
from tests.integration.correction_api.test_speaking import ALLOW, differ, microphone
from tests.integration.correction_api.visiting import FINGERS, Fingers, middle

TAP_S = 0.25
"""A finger that stays for less says nothing (`speak.js`)."""
BOXES = """
shown => {
  if (!document.querySelector(shown)) return null;
  return [".verdicts .freeze", ".verdicts .talk"].map(button => {
    const { left, top, width, height } = document.querySelector(button).getBoundingClientRect();
    return [left, top, width, height];
  });
}
"""
"""Where Freeze and "Hold and talk" stand while something is shown."""


def boxes(page: Page, shown: str) -> list[list[float]]:
    """Taken in the moment at which it is shown: some of it goes again by itself."""
    return list(page.wait_for_function(BOXES, arg=shown).json_value())


@pytest.mark.parametrize("size", [PHONE, SIDEWAYS], ids=["upright", "sideways"])
def test_a_finger_that_holds_the_button_speaks_and_no_button_moves_until_all_is_done(
    api: httpx.Client, robot: FakeRobot, size: tuple[int, int]
) -> None:
    robot.decide()
    phone = {"viewport": {"width": size[0], "height": size[1]}, **FINGERS}
    with microphone(str(api.base_url), "plate", ALLOW, **phone) as page:
        page.route("**/api/v1/speech*", differ)
        expect(page.locator("canvas.drawn")).to_have_count(2)
        finger = Fingers(page)
        stands = [boxes(page, ".speak.idle .talk:enabled")]
        finger.press(middle(page.get_by_role("button", name="Hold and talk")))
        stands.append(boxes(page, ".speak.listening .heard"))
        page.wait_for_timeout(2000 * TAP_S)
        finger.lift()
        stands.append(boxes(page, ".choice + .choice"))
        page.locator(".choice").nth(1).tap()
        stands.append(boxes(page, ".undo"))
        told = eventually(lambda: robot.heard)[0]
        assert told.goal is not None
        assert (told.kind, told.goal.text, told.heard) == (
            Kind.OVERRIDE,
            COMMANDS[2],
            "The plate.",
        )
        assert stands == [stands[0]] * 4
