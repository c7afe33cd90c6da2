"""The base of the high level: what its witnesses know, and that a stopped fit goes on."""

from pathlib import Path

import numpy as np
import pytest
import torch

from services.learner.pretrain import high_fit
from services.learner.pretrain.demonstrate import Demonstrations, Lesson, demonstrate
from services.learner.pretrain.high_fit import fit_high
from services.learner.pretrain.meanings import PLACES, SKIPPED, Prompts, Reader, meanings_of
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import shared_encoder
from shared.policies.checkpoint import sha256_tensors
from shared.policies.fit import agreement
from shared.policies.fitter import FitSettings
from shared.policies.high_level import BASE_VERSION, HighLevel
from shared.policies.high_net import HighLevelNet
from shared.policies.wishes import Wishes
from shared.workcell.objects import BIN, OBJECT_NAMES, TUB
from shared.workcell.skills import COMMANDS

SETTINGS = FitSettings(steps=4, batch=8)


@pytest.fixture(scope="module")
def lessons() -> Demonstrations:
    return demonstrate(Lesson(seeds=(11,)))


def test_meanings_are_what_the_tasks_understand() -> None:
    listed, denied, sided, bus = range(4)
    found = meanings_of(
        [
            "make a sandwich with ham and cheese",
            "pack everything but the tomato into the bin",
            "put only what is on the left in the bin",
            "clear the table",
        ]
    )
    rows = {name: row for row, name in enumerate(OBJECT_NAMES)}
    names = ("bread", "ham", "cheese", "toast")
    assert [int(found.order[listed, rows[name]]) for name in names] == [0, 1, 2, 3]
    assert found.wished[listed].sum() == 4
    assert found.wished[denied, rows["tomato"]] == 0
    assert found.wished[denied].sum() == 6
    assert (found.order[denied] == SKIPPED).all()
    assert found.told[denied].all()
    assert not found.told[sided, rows["bread"]]
    places = {name: int(found.place[bus, rows[name]]) for name in ("cup", "can", "bread")}
    assert places == {"cup": PLACES.index(TUB), "can": PLACES.index(BIN), "bread": SKIPPED}


def test_a_wish_is_read_word_by_word() -> None:
    torch.manual_seed(0)
    wishes, reader = Wishes(), Reader()
    prompts = Prompts(60, 0, shared_encoder())
    learner = torch.optim.Adam([*wishes.parameters(), *reader.parameters()], lr=2e-3)
    rights = []
    for step in range(80):
        words, meanings = prompts.draw(32, np.random.default_rng(step))
        loss, right = reader.loss(wishes(words), meanings)
        learner.zero_grad()
        loss.backward()
        learner.step()
        rights.append(right)
    assert np.mean(rights[:5]) < 0.85 < 0.9 < np.mean(rights[-5:])


def test_a_stopped_fit_goes_on_as_if_nothing_had_been(
    lessons: Demonstrations, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(high_fit, "KEPT_UPDATES", 2)
    kept = tmp_path / "under-way.safetensors"
    whole, _ = fitted(lessons, 4, None)
    _, first = fitted(lessons, 3, kept)
    assert first == [1, 2, 3]
    again, rest = fitted(lessons, 4, kept)
    assert rest == [3, 4]
    assert sha256_tensors(again.tensors()) == sha256_tensors(whole.tensors())


def fitted(lessons: Demonstrations, most: int, kept: Path | None) -> tuple[HighLevel, list[int]]:
    """A fit that is stopped after `most` updates, and the updates that it told of."""
    told: list[int] = []

    def progress(step: int, steps: int, loss: float) -> bool:
        assert np.isfinite(loss)
        told.append(step)
        return step < min(most, steps)

    torch.manual_seed(0)
    net, bank = HighLevelNet(), PhraseBank.of(COMMANDS)
    net.learn_senses(torch.from_numpy(lessons.examples.senses))
    fit_high(net, bank, lessons, SETTINGS, progress, prompts=6, kept=kept)
    assert 0 <= agreement(net, bank, lessons.examples).text <= 1
    return HighLevel(net, bank, BASE_VERSION), told
