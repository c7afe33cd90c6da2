"""`hld review`: what people still have to settle, and what they say to it.

Opens the SQLite store beside a learner that may be running; what is settled counts from the next
round on.
"""

import json
import time
from collections.abc import Iterable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Annotated, Any, NoReturn, Optional

import typer
from pydantic import ValidationError
from rich import box
from rich.console import Console
from rich.table import Table

from services.learner.kept import Data, Report, find_folder, open_store, write_report
from services.learner.labels.aggregate import LabelSettings
from services.learner.labels.amend import Standing, amended
from services.learner.labels.review import Contradiction, Meaning, Review, review
from services.learner.labels.spell import spelling
from services.learner.store.store import History, Kept, Manifest, Store
from shared.config import exit_misconfigured
from shared.errors import ConfigError, nearest
from shared.messages.correction import Correction, Kind
from shared.messages.message import new_id
from shared.messages.ruling import Ruling, Verb
from shared.service import run_app

SCHEMA = 1
Author = Annotated[str, typer.Option(help="who says so")]
Reason = Annotated[str, typer.Option(help="why, for those who ask later")]
LowLevelFolder = Annotated[
    Optional[Path], typer.Option(help="checkpoint whose reader tells what phrases mean")
]
app = typer.Typer(add_completion=False, no_args_is_help=True)


@app.callback()
def _review() -> None:
    """Contradictions between people, and phrases that may mean the same."""


@app.command("list")
def list_open(
    data: Data = Path("runs/up"), report: Report = None, low_level: LowLevelFolder = None
) -> None:
    """All that is open: who contradicts whom, and which phrases seem to be known commands."""
    settings = _label_settings(data)
    with closing(open_store(data, "review")) as store:
        history, first = _everything(store), store.version(0)
    found = review(history, settings, first.bank if first else (), _reader(low_level))
    write_report(report, _told(found))
    console = Console(markup=False)
    console.print(_contradictions(found))
    console.print(_wordings(found))
    console.print(f"faults laid on the hand, for the low level: {found.faults}")


@app.command()
def alias(
    phrase: Annotated[str, typer.Argument(help="what was said")],
    means: Annotated[str, typer.Argument(help="what labels are to say instead")],
    data: Data = Path("runs/up"),
    author: Author = "person",
    reason: Reason = "",
) -> None:
    """PHRASE is another wording of MEANS, in all labels from the next round on."""
    _rule(data, Verb.ALIAS, phrase, means, author, reason)


@app.command()
def distinct(
    phrase: Annotated[str, typer.Argument(help="what was said")],
    means: Annotated[str, typer.Argument(help="what it does not mean")],
    data: Data = Path("runs/up"),
    author: Author = "person",
    reason: Reason = "",
) -> None:
    """PHRASE doesn't mean MEANS, and is not to be asked about again."""
    _rule(data, Verb.DISTINCT, phrase, means, author, reason)


@app.command()
def settle(
    which: Annotated[str, typer.Argument(help="number in `hld review list`, or an episode")],
    keep: Annotated[str, typer.Option(help="the correction that was right")],
    data: Data = Path("runs/up"),
    author: Author = "person",
    reason: Reason = "",
) -> None:
    """Take back what contradicts one correction; of what was said of steps, for those alone.

    Kept by the learner, for its labels; the page goes on showing what was said.
    """
    settings, console = _label_settings(data), Console(markup=False)
    with closing(open_store(data, "review")) as store:
        history = _everything(store)
        found = review(history, settings, (), lambda _: None).contradictions
        wrong = _contradicting(found, which, keep)
        standing = {
            one.correction.id: one for one in amended(history.corrections, history.receipts)
        }
        for id_, steps in wrong.items():
            one, why = standing[id_], reason or f"{keep} was right"
            _add(store, _retraction(one.correction, author, why))
            console.print(f"taken back: {id_} of {one.correction.author}")
            ahead = settings.anticipate_steps
            wrong_steps = [range(cut.start + ahead, cut.stop + ahead) for cut in steps]
            for left in rest(one.span or range(0), wrong_steps):
                _add(store, _said_again(one, left, f"{id_} but for what {keep} contradicts"))
                console.print(f"kept of it: steps {left.start} to {left.stop - 1}")


def rest(span: range, cuts: Iterable[range]) -> Iterator[range]:
    """What is left of a stretch of steps without others, in order."""
    first = span.start
    for cut in sorted(cuts, key=lambda cut: cut.start):
        if first < min(cut.start, span.stop):
            yield range(first, min(cut.start, span.stop))
        first = max(first, cut.stop)
    if first < span.stop:
        yield range(first, span.stop)


def _said_again(one: Standing, steps: range, note: str) -> Correction:
    """A part of what somebody said of the past, as if they had said no more, and as early."""
    said, (created_ns, _) = one.correction, one.order
    kind = Kind.FAULT if said.kind is Kind.FAULT else Kind.RELABEL
    return Correction(
        id=new_id("say"),
        robot=said.robot,
        episode=said.episode,
        kind=kind,
        author=said.author,
        goal=said.goal,
        first_step=steps.start,
        end_step=steps.stop,
        begun_ns=said.begun_ns,
        created_ns=created_ns,
        note=note,
    )


def _contradicting(
    found: tuple[Contradiction, ...], which: str, keep: str
) -> dict[str, list[range]]:
    """The corrections that contradict `keep` where `which` says, and over which steps."""
    if which.isdecimal():
        chosen = found[int(which) - 1 : int(which)] if int(which) else ()
    else:
        chosen = tuple(one for one in found if one.episode == which)
    if not chosen:
        episodes = sorted({one.episode for one in found})
        known = (
            f"there are 1 to {len(found)}, in {', '.join(episodes)}" if found else "none is open"
        )
        exit_misconfigured("review", ConfigError(f"no contradiction {which}; {known}"))
    wrong: dict[str, list[range]] = {}
    known_ids = set[str]()
    for one in chosen:
        pair = {one.one.correction, one.other.correction}
        known_ids |= pair
        for id_ in pair - {keep} if keep in pair else ():
            first, last = one.steps
            wrong.setdefault(id_, []).append(range(first, last + 1))
    if not wrong:
        hint = nearest(keep, sorted(known_ids))
        exit_misconfigured("review", ConfigError(f"{keep} is in no contradiction {which}{hint}"))
    return wrong


def _retraction(said: Correction, author: str, reason: str) -> Correction:
    now_ns = time.time_ns()
    try:
        return Correction(
            id=new_id("say"),
            robot=said.robot,
            episode=said.episode,
            kind=Kind.RETRACT,
            author=author,
            target=said.id,
            begun_ns=now_ns,
            created_ns=now_ns,
            note=reason,
        )
    except ValidationError as error:
        _exit_invalid(error)


def _rule(data: Path, verb: Verb, phrase: str, means: str, author: str, reason: str) -> None:
    try:
        ruling = Ruling(
            id=new_id("rule"),
            verb=verb,
            author=author,
            phrase=phrase,
            means=means,
            reason=reason,
            created_ns=time.time_ns(),
        )
    except ValidationError as error:
        _exit_invalid(error)
    with closing(open_store(data, "review")) as store:
        spell = spelling((*_everything(store).rulings, ruling))
        one, other = spell(phrase), spell(means)
        _add(store, ruling)
    if verb is Verb.ALIAS:
        print(f"from the next round on labels say “{one}” for both")
    elif one == other:
        print(f"kept, but other aliases still make “{one}” of both: rule on those, too")
    else:
        print(f"from the next round on labels keep “{one}” and “{other}” apart")


def _exit_invalid(error: ValidationError) -> NoReturn:
    first = error.errors(include_url=False)[0]
    place = ".".join(map(str, first["loc"]))
    exit_misconfigured("review", ConfigError(f"{place}: {first['msg']}".removeprefix(": ")))


def _add(store: Store, message: Kept) -> None:
    store.add(message, time.time_ns())


def _everything(store: Store) -> History:
    return store.history(Manifest(marks=store.survey(Manifest()).marks))


def _label_settings(data: Path) -> LabelSettings:
    """As the learner of this run has them; the defaults, where it wrote none down."""
    file = find_folder(data, "review") / "settings.json"
    stored = json.loads(file.read_text()) if file.is_file() else {}
    return LabelSettings.model_validate(stored.get("labels", {}))


def _reader(folder: Path | None) -> Meaning:
    """What the low level takes phrases for, with everything there that a scene can have.

    Its reader and not the likeness of sentences: to that, the ham and the cheese are neighbours.
    """
    from services.learner.train import reader  # Here, and torch with it: only the list waits.
    from shared.policies.checkpoint import bundled

    return reader(folder or bundled("low_level"))


def _told(found: Review) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "contradictions": [
            {
                "number": number,
                "episode": one.episode,
                "steps": list(one.steps),
                "decisions": list(one.decisions),
                "said": [
                    {"author": said.author, "correction": said.correction, "text": said.text}
                    for said in (one.one, one.other)
                ],
            }
            for number, one in enumerate(found.contradictions, start=1)
        ],
        "wordings": [wording._asdict() for wording in found.wordings],
        "faults": found.faults,
    }


def _contradictions(found: Review) -> Table | str:
    """It fits into 80 columns; which decisions they are about stands in the report."""
    if not found.contradictions:
        return "nobody contradicts anybody"
    table = Table(box=box.SIMPLE)
    for name in ("", "who", "correction"):
        table.add_column(name, no_wrap=True)
    table.add_column("says")
    for number, one in enumerate(found.contradictions, start=1):
        first, last = one.steps
        where = f"steps {first} to {last}" if last > first else f"step {first}"
        table.add_row(str(number), "", one.episode, where)
        for said in (one.one, one.other):
            table.add_row("", said.author[:16], said.correction, said.text)
    return table


def _wordings(found: Review) -> Table | str:
    if not found.wordings:
        return "no phrase seems to be another wording of a command"
    table = Table("said", "times", "seems to mean", box=box.SIMPLE)
    for wording in found.wordings:
        table.add_row(wording.phrase, str(wording.times), wording.means)
    return table


if __name__ == "__main__":
    run_app(app)
