"""Which proposal takes force: the best that the low level can do, and no flicker between two.

Source: the running mean of scores is that of SRT-H (Kim et al. 2025, arXiv 2505.10251: over the
last 3); margin and dwell are the two other classic guards against chatter.
"""

from collections.abc import Callable, Sequence

from shared.messages.decision import Choice, Proposal
from shared.messages.goal import Goal
from shared.rollout.settings import RolloutSettings


class Choosing:
    """What the high level has in force, or would have if nobody's word held. One for an episode.

    goal: that; None before its first answer. chosen_by: the version that chose it.
    """

    def __init__(self, settings: RolloutSettings) -> None:
        self._settings = settings
        self._scores: dict[str, float] = {}  # of goals by their text
        self.goal: Goal | None = None
        self.chosen_by = ""

    def choose(
        self,
        proposals: Sequence[Proposal],
        version: str,
        objects_to: Callable[[Goal], bool],
        age_steps: int | None,
    ) -> Choice:
        """Take up the goal that follows from what `version` proposes, and say how it does.

        If the low level objects to every proposal the goal stays what it was; at first it is what
        was proposed first, since a robot that stands for ever can't be corrected either.

        age_steps: since when `goal` is in force. None: it has no claim to stay, as after a word, a
            completion or a stuck timer, and the mean of the scores begins anew.
        """
        kept = self.goal if age_steps is not None else None
        ranked = self._rank(proposals, anew=kept is None)
        best = next((goal for goal in ranked if not objects_to(goal)), None)
        if best is None:
            if self.goal is None:
                self.goal, self.chosen_by = proposals[0].goal, version
            return Choice.OBJECTION
        if kept is not None and best != kept and not objects_to(kept):
            if (age_steps or 0) < self._settings.dwell_steps:
                return Choice.DWELL
            lead = self._scores[best.text] - self._scores.get(kept.text, 0.0)
            if lead < self._settings.hysteresis:
                return Choice.HYSTERESIS
        self.goal, self.chosen_by = best, version
        if best == proposals[0].goal:
            return Choice.BEST
        return Choice.SMOOTHED if best == ranked[0] else Choice.OBJECTION

    def _rank(self, proposals: Sequence[Proposal], anew: bool) -> list[Goal]:
        """The proposed goals by the running mean of their scores, which it brings up to date.

        A goal that isn't proposed scores 0 at that look.
        """
        old = {} if anew else self._scores
        new: dict[str, float] = {}
        for proposal in proposals:
            new.setdefault(proposal.goal.text, proposal.score)
        weight = self._settings.smoothing if old else 0.0
        self._scores = {
            text: weight * old.get(text, 0.0) + (1 - weight) * new.get(text, 0.0)
            for text in old | new
        }
        goals = [proposal.goal for proposal in proposals]
        return sorted(goals, key=lambda goal: self._scores[goal.text], reverse=True)
