"""Judge a candidate before any robot sees it; between training and publishing.

First by what it says: agreement with what people said, and with what was demonstrated. Then, where
there is a simulator, by what it does (`trials.py`). By setting, one robot goes first (`canary.py`).
"""

from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

from services.learner.canary import CanarySettings
from services.learner.held_out import TELLING
from services.learner.trials import Trials, TrialSettings, compare
from shared.config import Settings
from shared.errors import RefusedError
from shared.messages.policy import PolicyAnnouncement, TensorRef

ADVICE = (
    "corrections go on being gathered, and a round with more corrected episodes judges; to let it "
    "out all the same, promote it, or set gate.unjudged=let-out"
)


class GateSettings(Settings):
    """What a candidate must be able to show.

    held_out_share: of the corrected episodes, those that no round trains on; chosen by their
        ids, so that they stay the same ones. at_least: labels among them, below which their
        agreement says too little to be judged by; a small round holds out more for it, which a
        later one may learn from, see `held_out.split`.
    unjudged: what becomes of a candidate that so few labels can't judge, where no `trials` do, or
        in which it never succeeds: refuse: it stays here, and a later round has more to judge by;
        let-out: it goes out.
    max_fall: by which the agreement with them may fall, against the version in force.
    fall_chance: a greater fall is borne where `Figures.p_fall` is above this, since labels of one
        episode fall together and few episodes scatter; one above most_fall never is. Of three
        episodes that all fall p is .125: below that nothing would be refused for them.
    chance: a version in force that is wrong about most of them has to be bettered, with McNemar's p
        at most this, or else in `trials`, with p at most theirs: what learned nothing where people
        spoke agrees no less. 1: it need not be.
    retained: demonstrated decisions that no round replays, to see what is forgotten. max_forgotten:
        by which the agreement with those may fall, against the version in force.
    trials: episodes in simulation. canary: robots that run it first.
    """

    held_out_share: Annotated[float, Field(ge=0, lt=1)] = 0.1
    at_least: Annotated[int, Field(ge=1)] = 20
    unjudged: Literal["refuse", "let-out"] = "refuse"
    max_fall: Annotated[float, Field(ge=0, le=1)] = 0.05
    fall_chance: Annotated[float, Field(ge=2**-TELLING, le=1)] = 0.2
    most_fall: Annotated[float, Field(ge=0, le=1)] = 0.15
    chance: Annotated[float, Field(gt=0, le=1)] = 0.05
    retained: Annotated[int, Field(ge=0, le=10_000)] = 200
    max_forgotten: Annotated[float, Field(ge=0, le=1)] = 0.05
    trials: TrialSettings = TrialSettings()
    canary: CanarySettings = CanarySettings()


class Figures(BaseModel):
    """What the training of a round reported.

    labels, held_out: decisions that it learned from, and that it kept aside.
    labels_sha256: over all of both, so that a rebuilt data set can be held against it.
    before, after: share of the held-out labels that the version in force and the candidate
        propose first, in whatever words; None where nothing was held out. p: McNemar's, of both.
    p_fall: how probable it is that they fall so much by chance, episode by episode; None: where
        fewer than `held_out.TELLING` episodes differ, none can tell.
    retained: demonstrated decisions that were kept aside; retained_before, retained_after: the
        share of them that both propose rightly.
    unread: phrases that people said of the past and that the low level understands no command in;
        they are in no bank, and nothing was learned from them.
    code: which code trained it; another one than in the manifest where a later learner went on.
    loss: mean over the last steps. finite: no weight is infinite or not a number. seconds: it took.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    labels: int
    labels_sha256: str
    held_out: int
    loss: float | None
    finite: bool
    seconds: float
    before: float | None = None
    after: float | None = None
    p: float | None = None
    p_fall: float | None = None
    retained: int = 0
    retained_before: float | None = None
    retained_after: float | None = None
    unread: tuple[str, ...] = ()
    code: str = ""


class Candidate(BaseModel):
    """What a round made and nobody has seen yet.

    tensors: their bytes lie in the store's `TensorFiles`. bank, settings: as in
    `PolicyAnnouncement`.
    learned, held_out: ids of the corrections whose labels it was trained with, and of those whose
    labels were kept aside; empty in records from before this was told.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    tensors: tuple[TensorRef, ...]
    bank: tuple[str, ...]
    settings: dict[str, int | float | str | bool]
    figures: Figures
    learned: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()


class Verdict(NamedTuple):
    """Whether a candidate goes out, why not, and what was found in trials.

    unjudged: why it could not be held against what people said; "" where it was.
    pending: why it is to stay here all the same, unless trials show that it does something.
    """

    passed: bool
    reason: str = ""
    figures: dict[str, Any] = {}
    unjudged: str = ""
    pending: str = ""


class Gate:
    """Decides whether a candidate goes out; asked by the learner's own thread."""

    def __init__(self, settings: GateSettings, trials: Trials) -> None:
        self._labels, self._trials, self._settings = LabelGate(settings), trials, settings
        self._trying, self._said = False, Verdict(True)

    def start(self) -> None:
        """Begin to hand out trials."""
        self._trials.start()

    def begin(
        self, candidate: Candidate, announced: PolicyAnnouncement, in_force: PolicyAnnouncement
    ) -> Verdict | None:
        """Judge a candidate; None: not before its trials are over. announced: as it would be."""
        verdict = self._labels.judge(candidate)
        if not verdict.passed or not self._settings.trials.episodes:
            return verdict
        self._trials.begin(announced, in_force)
        self._trying, self._said = True, verdict
        return None

    def poll(self) -> Verdict | None:
        """The verdict, once its trials are over."""
        try:
            outcomes = self._trials.outcomes()
        except RefusedError as error:
            self.stop()
            return Verdict(False, str(error), unjudged=self._said.unjudged)
        if outcomes is None:
            return None
        self.stop()
        reason, figures = compare(*outcomes, self._settings.trials)
        mine, its = map(sum, outcomes)
        reason = reason or self._still_pending(mine, its, figures["p"])
        return Verdict(not reason, reason, figures, self._said.unjudged)

    def _still_pending(self, mine: int, its: int, p: float) -> str:
        """Why labels hold it back, if trials show too little that speaks for it.

        mine, its: successes of the candidate and of the version in force on the same scenes.
        p: of their difference.
        """
        unjudged, trials = self._said.unjudged, self._settings.trials
        shown = mine > 0 if unjudged else mine > its and p <= trials.chance
        if shown or not self._said.pending:
            return ""
        scenes = f"of {trials.episodes} scenes it succeeds in {mine}, the version in force in {its}"
        if unjudged:
            return f"{unjudged}; {scenes}; {ADVICE}"
        return (
            f"{self._said.pending}; and {scenes} (p = {p:.2f}; gate.trials.chance={trials.chance})"
        )

    def progress(self) -> float:
        """How far the trials are, 0 to 1."""
        return self._trials.progress() if self._trying else 0.0

    def stop(self) -> None:
        """Give up what is being tried, if anything is."""
        self._trials.stop()
        self._trying = False

    def close(self) -> None:
        """Hand out no more."""
        self._trials.close()


class LabelGate:
    """Holds a candidate against labels that it was not trained on.

    A candidate that agrees less with what people said would do worse in the same scenes;
    that it does better in new ones is for an evaluation to show.
    """

    def __init__(self, settings: GateSettings) -> None:
        self._settings = settings

    def judge(self, candidate: Candidate) -> Verdict:
        """Whether it agrees as much as it must; what can't be judged is no agreement."""
        if not candidate.figures.finite:
            return Verdict(False, "a weight is infinite or not a number")
        unjudged = self._unjudged(candidate.figures)
        worse = "" if unjudged else self._worse(candidate.figures)
        reason = worse or self._forgot(candidate.figures)
        pending = f"{unjudged}; {ADVICE}" if unjudged else self._no_better(candidate.figures)
        if unjudged and self._settings.unjudged == "let-out":
            pending = ""
        if not self._settings.trials.episodes:  # Nothing more will be known.
            reason, pending = reason or pending, ""
        return Verdict(not reason, reason, unjudged=unjudged, pending=pending)

    def _unjudged(self, figures: Figures) -> str:
        needs = self._settings.at_least
        if figures.held_out >= needs:
            return ""
        return f"held out {figures.held_out} labels, needs {needs}: not judged"

    def _worse(self, figures: Figures) -> str:
        """Why it agrees too little with what people said; "" if it doesn't."""
        before, after, settings = figures.before, figures.after, self._settings
        what, p = f"{figures.held_out} held-out labels", figures.p_fall
        fallen = _fallen(what, before, after, settings.max_fall)
        if not fallen or p is None or _fallen(what, before, after, settings.most_fall):
            return fallen
        if p > settings.fall_chance:
            return ""
        allowed = f"p = {p:.3f}; gate.fall_chance={settings.fall_chance}"
        return f"{fallen}, or what chance explains ({allowed})"

    def _no_better(self, figures: Figures) -> str:
        """Why it has learned too little, where there was most to learn; "" if it has enough."""
        before, after, p, most = figures.before, figures.after, figures.p, self._settings.chance
        if before is None or after is None or p is None or before >= 0.5:
            return ""
        if most == 1 or (after > before and p <= most):
            return ""
        return (
            f"it agrees with {after:.3f} of {figures.held_out} held-out labels, the version in "
            f"force with {before:.3f}: who follows one that is wrong about most of them has to be "
            f"right more often by more than chance (p = {p:.2f}; gate.chance={most})"
        )

    def _forgot(self, figures: Figures) -> str:
        """Why it has forgotten too much of what was demonstrated; "" if it hasn't."""
        fall = figures.retained_before, figures.retained_after, self._settings.max_forgotten
        return _fallen(f"{figures.retained} demonstrated decisions", *fall)


def _fallen(what: str, before: float | None, after: float | None, allowed: float) -> str:
    if before is None or after is None or after >= before - allowed:
        return ""
    return (
        f"it agrees with {after:.3f} of {what}, the version in force with {before:.3f}; "
        f"{allowed} less is allowed"
    )
