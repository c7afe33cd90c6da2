"""The examples of the OpenAPI text are what the routes would answer."""

import pytest
from pydantic import BaseModel, TypeAdapter

from services.correction_api import examples, examples_after
from services.correction_api.afterwards import (
    EpisodeAccount,
    PolicyHistory,
    Progress,
    Reports,
    RulingView,
)
from services.correction_api.pause import EXAMPLES as STOPPED
from services.correction_api.pause import PauseBody, PauseView
from services.correction_api.phrases import Commands, Understood
from services.correction_api.rule import EXAMPLES as RULED
from services.correction_api.rule import RulingBody
from services.correction_api.utterance import EXAMPLES, Utterance
from services.correction_api.views import (
    CorrectionPage,
    CorrectionView,
    EpisodePage,
    HelpQueue,
    LearnerView,
    RobotView,
)
from shared.messages.recording import Recording

CASES = [
    (RobotView, examples.ROBOT),
    (CorrectionView, examples.CORRECTION),
    (CorrectionView, examples.PENDING),
    (CorrectionPage, examples.CORRECTIONS),
    (PauseView, examples.PAUSED),
    (EpisodePage, examples_after.EPISODES),
    (EpisodeAccount, examples_after.ACCOUNT),
    (Recording, examples_after.RECORDING),
    (Progress, examples_after.PROGRESS),
    (PolicyHistory, examples_after.POLICY),
    (RulingView, examples_after.RULING),
    (Reports, examples_after.REPORTS),
    (HelpQueue, examples.HELP),
    (Commands, examples.COMMANDS),
    (Understood, examples.UNDERSTOOD),
    (LearnerView, examples.LEARNER),
    *((Utterance, example) for example in EXAMPLES),
    *((RulingBody, example) for example in RULED),
    *((PauseBody, example) for example in STOPPED),
]


@pytest.mark.parametrize(("model", "example"), CASES)
def test_an_example_is_what_its_model_says(model: type[BaseModel], example: object) -> None:
    made = TypeAdapter(model).validate_python(example)
    shown = made.model_dump(mode="json", exclude_unset=True)
    assert shown == example
