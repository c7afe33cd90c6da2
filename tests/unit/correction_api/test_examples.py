"""The examples of the OpenAPI text are what the routes would answer."""

import pytest
from pydantic import BaseModel, TypeAdapter

from services.correction_api import examples
from services.correction_api.utterance import EXAMPLES, Utterance
from services.correction_api.views import (
    CorrectionPage,
    CorrectionView,
    EpisodePage,
    HelpQueue,
    LearnerView,
    RobotView,
)

CASES = [
    (RobotView, examples.ROBOT),
    (CorrectionView, examples.CORRECTION),
    (CorrectionView, examples.PENDING),
    (CorrectionPage, examples.CORRECTIONS),
    (EpisodePage, examples.EPISODES),
    (HelpQueue, examples.HELP),
    (LearnerView, examples.LEARNER),
    *((Utterance, example) for example in EXAMPLES),
]


@pytest.mark.parametrize(("model", "example"), CASES)
def test_an_example_is_what_its_model_says(model: type[BaseModel], example: object) -> None:
    made = TypeAdapter(model).validate_python(example)
    shown = made.model_dump(mode="json", exclude_unset=True)
    assert shown == example
