"""The desk before real robots and a real learner: what a person does by word, key and voice there,
and what comes of it afterwards, up to the version that learned it.
"""

import re
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Browser, Error, Page, expect

from tests.integration.correction_api.browsing import drag_stretch, focused, launched, line
from tests.integration.correction_api.test_access import at_work
from tests.integration.correction_api.test_speaking import ALLOW, LEAD_S, microphone
from tests.integration.correction_api.visiting import visited
from tests.loop.fleet import Fleet
from tests.waves import length_s

pytestmark = pytest.mark.alone

SETS = (
    "actor.rollout.max_steps=1500",  # Half a minute: episodes end while the tests run.
    "actor.help.threshold=0.2",
    "actor.help.pause_steps=0",
    "learner.round.corrections=1",
    "learner.round.after_s=0",
    "learner.train.steps=3",
    "learner.train.epochs=0",
    "learner.train.nice=0",
    "learner.gate.max_fall=1",  # So few updates make no better version.
    "learner.gate.max_forgotten=1",
    "learner.gate.retained=20",
    "learner.gate.held_out_share=0",  # All that is said is learned.
    "learner.gate.unjudged=let-out",
)


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Fleet]:
    """Two robots in real time at a site where the base knows little, and nobody but the page."""
    folder = tmp_path_factory.mktemp("desk")
    with Fleet(folder, robots=2, pace="real-time", tasks=("sandwich",), sets=SETS) as fleet:
        fleet.robot("robot-1")
        fleet.robot("robot-2")
        yield fleet


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with launched() as browser:
        yield browser


def desk(fleet: Fleet) -> str:
    """Where the page is."""
    return f"http://127.0.0.1:{fleet.plan.port}/"


@pytest.fixture
def page(browser: Browser, fleet: Fleet) -> Iterator[Page]:
    """The live page, on which robot-1 is in focus."""
    with visited(browser, desk(fleet)) as page:
        at_work(page)
        yield page


def told(fleet: Fleet, kind: str) -> list[tuple[str, str, str]]:
    """Robot, words and status of what was said in one way, the oldest first."""
    views = fleet.get("/corrections?limit=200")["corrections"]
    return [
        (one["robot"], (one["goal"] or {}).get("text", ""), view["status"])
        for view in reversed(views)
        if (one := view["correction"])["kind"] == kind
    ]


def again(fleet: Fleet, attempt: Callable[[], bool], what: str) -> None:
    """A person's attempt, until it works: a scene ends, or another command is in force by now."""

    def tried() -> bool:
        try:
            return attempt()
        except (Error, AssertionError):  # `expect` gave up.
            return False

    fleet.wait_for(tried, what)


@pytest.mark.timeout(400)
def test_a_real_robot_does_what_was_spoken(fleet: Fleet) -> None:
    """The first one here: its browser has a microphone, and no other may run beside it."""
    with microphone(desk(fleet), "cheese", ALLOW) as page:

        def attempt() -> bool:
            page.reload()
            at_work(page)
            page.keyboard.down(" ")
            expect(page.locator(".speak.listening")).to_be_visible()
            page.wait_for_timeout(1000 * (LEAD_S + length_s("cheese") + 0.5))
            page.keyboard.up(" ")
            expect(page.locator(".speak.choosing, .speak.done, .speak.told")).to_be_visible()
            chip = page.locator(".choice:has-text('pick up the cheese')")
            if chip.count():
                chip.first.click()
            expect(line(page)).to_have_text(re.compile("^“.+”, robot-1: (in|ref)"))
            newest = fleet.get("/corrections?limit=1")["corrections"][0]
            return bool(newest["correction"]["heard"]) and newest["status"] == "in force"

        again(fleet, attempt, "the spoken words were obeyed")


@pytest.mark.timeout(400)
def test_a_few_letters_find_a_command_that_a_real_robot_obeys(page: Page, fleet: Fleet) -> None:
    def attempt() -> bool:
        page.keyboard.press("/")
        page.keyboard.type("chese")
        expect(page.locator("[role=option]").first).to_contain_text("pick up the cheese")
        page.keyboard.press("Enter")
        expect(line(page)).to_have_text(re.compile("^“pick up the cheese”, robot-1: (in|ref)"))
        return ("robot-1", "pick up the cheese", "in force") in told(fleet, "override")

    again(fleet, attempt, "the cheese was obeyed")


@pytest.mark.timeout(400)
def test_a_slip_of_the_hand_and_an_approval_by_a_key_of_ones_own_reach_the_learner(
    page: Page, fleet: Fleet
) -> None:
    page.keyboard.press("f")
    fleet.wait_for(lambda: told(fleet, "fault"), "the slip was told")
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Keys")
    dialog.get_by_role("button", name="Key for: That is right").click()
    page.keyboard.press("j")
    dialog.get_by_role("button", name="Close").click()
    expect(page.locator(".verdicts .approve kbd")).to_have_text("j")
    page.keyboard.press("j")
    fleet.wait_for(lambda: told(fleet, "approve"), "the approval was told")
    kept = "select count(distinct kind) from corrections where kind in ('fault', 'approve')"
    fleet.wait_for(lambda: fleet.read("learner", kept)[0][0] == 2, "the learner keeps both")


@pytest.mark.timeout(400)
def test_the_next_key_goes_to_a_real_robot_in_doubt(page: Page, fleet: Fleet) -> None:
    def asks(robot: str) -> bool:
        return robot in {one["robot"] for one in fleet.get("/help")["asking"]}

    def attempt() -> bool:
        page.locator("[data-tile=robot-1]").click()
        fleet.wait_for(lambda: asks("robot-2"), "robot-2 is in doubt")
        page.keyboard.press("n")
        page.wait_for_timeout(700)  # A letter waits whether it begins a sentence.
        return focused(page).inner_text() == "robot-2"

    again(fleet, attempt, "robot-2 came into focus")


@pytest.mark.timeout(400)
def test_one_press_freezes_both_real_robots_and_each_carries_on_when_it_is_told(
    page: Page, fleet: Fleet
) -> None:
    def frozen() -> list[str]:
        robots = fleet.get("/robots")["robots"]
        return [one["robot"] for one in robots if one["state"] == "paused"]

    page.keyboard.press("Shift+Escape")
    fleet.wait_for(lambda: sorted(frozen()) == ["robot-1", "robot-2"], "both robots stand still")
    expect(line(page)).to_have_text("Both robots are frozen")
    for robot, left in (("robot-2", ["robot-1"]), ("robot-1", list[str]())):
        page.locator(f"[data-tile={robot}]").click()
        page.get_by_role("button", name="Carry on").click()
        fleet.wait_for(lambda left=left: frozen() == left, f"{robot} carries on")


@pytest.mark.timeout(600)
def test_what_is_said_of_a_real_episode_afterwards_becomes_a_version(
    browser: Browser, fleet: Fleet
) -> None:
    over = fleet.wait_for(lambda: fleet.get("/episodes")["episodes"], "an episode is over")[-1]
    with visited(browser, f"{desk(fleet)}episode.html?id={over['id']}") as page:
        form = drag_stretch(page, 0.3, 0.6)
        form.get_by_label("the right command").fill("pick up the bread")
        form.get_by_role("button", name="Keep").click()
        row = page.locator("tr[data-correction]").last
        expect(row).to_contain_text("relabelledpick up the bread")
        id_ = row.get_attribute("data-correction")
    version = fleet.wait_for(
        lambda: fleet.get(f"/corrections/{id_}")["learned_in"], "a version learned it"
    )
    with visited(browser, f"{desk(fleet)}progress.html") as page:
        expect(page.get_by_role("cell", name=version, exact=True).first).to_be_visible()


@pytest.mark.timeout(600)
def test_a_person_rolls_back_on_the_page_and_real_robots_run_the_old_weights(
    browser: Browser, fleet: Fleet
) -> None:
    fleet.wait_for(lambda: fleet.get("/policy")["version"] != "1.0", "a round made a version")
    with visited(browser, f"{desk(fleet)}progress.html") as page:
        page.get_by_label("You are").fill("anna")
        back = page.get_by_role("form", name="Roll back")
        back.get_by_label("version").select_option("0")
        back.get_by_label("reason").fill("it drops the bread")
        back.get_by_role("button").click()
        expect(page.locator("tr[data-ruling]").first).to_contain_text("done")

    def runs_what_was_rolled_back_to() -> bool:
        policy = fleet.get("/policy")
        weights = {one["version"]: one["again"] for one in policy["versions"]}
        running = [robot["version"] for robot in fleet.get("/robots")["robots"]]
        return all(weights.get(version) == 0 for version in running)

    fleet.wait_for(runs_what_was_rolled_back_to, "both robots run the weights of 1.0 again")
