"""Two people before one real robot, each with a page and a token of their own."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from services.correction_api.people import fresh_token, hashed
from tests.integration.correction_api.browsing import line, said
from tests.integration.correction_api.processes import Cell
from tests.integration.correction_api.test_access import at_work
from tests.integration.correction_api.visiting import visited

TOKENS = {name: fresh_token() for name in ("anna", "ben")}


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cell]:
    """One robot that only Anna and Ben may correct."""
    people = {name: hashed(token) for name, token in TOKENS.items()}
    folder: Path = tmp_path_factory.mktemp("guarded")
    with Cell(folder, robots=1, people=people, token=TOKENS["anna"] + "-of-the-test") as cell:
        yield cell


@contextmanager
def unlocked(browser: Browser, cell: Cell, name: str) -> Iterator[Page]:
    """The page of a person, once they have given their token."""
    with visited(browser, cell.url, outage=True) as page:
        page.get_by_label("Token of this service").fill(TOKENS[name])
        page.get_by_role("button", name="Open").click()
        at_work(page)
        yield page


def say(page: Page, text: str) -> None:
    field = page.locator("input[name=words]")
    field.fill(text)
    field.press("Enter")
    expect(line(page)).to_contain_text(f"“{text}”")
    expect(line(page)).to_contain_text("in force since step")


def test_the_later_word_holds_and_both_see_whose_it_is(browser: Browser, guarded: Cell) -> None:
    with unlocked(browser, guarded, "anna") as anna, unlocked(browser, guarded, "ben") as ben:
        for page, name in ((anna, "anna"), (ben, "ben")):
            expect(page.locator("input[name=author]")).to_have_value(name)
            expect(page.locator("input[name=author]")).not_to_be_editable()
        expect(anna.get_by_text("ben is here, too")).to_be_visible()
        say(anna, "pick up the cheese")
        expect(said(ben).first).to_contain_text("“pick up the cheese”")
        expect(said(ben).first).to_contain_text("anna")
        say(ben, "wait")
        for page, whom in ((anna, "ben"), (ben, "you")):
            expect(page.locator(".caption q")).to_have_text("wait")
            expect(page.locator(".who")).to_have_text("told by ben")
            expect(said(page).nth(1)).to_contain_text(f"replaced by {whom}")
