"""The mover behind a soft pointer: where that is sure it acts as under a command; what the control
tells it in learning and in acting."""

import numpy as np
import torch
from torch.nn import functional as F

from services.learner.baselines import fit
from services.learner.baselines.net import Advice
from services.learner.baselines.policy import Mind
from services.learner.baselines.work import fresh
from services.learner.pretrain.demonstrate import NOTHING
from shared.goals.language.bank import PhraseBank
from shared.messages.observation import Observation
from shared.policies.tokens import OBJECTS
from shared.workcell.objects import BODY_NAMES
from shared.workcell.skills import COMMANDS
from tests.unit.baselines.taught import SETTINGS, begun, few, teaching

SURE = 40.0
"""A logit beside which no other has a share."""


def test_a_sure_pointer_moves_an_arm_as_its_command_does():
    pair = fresh("latent", 0, teaching())
    looks, steps = fit.lessons_of(teaching(), "hierarchy")
    rows = fit.LookRows(looks, steps, pair.mover.geometry, 4)
    view, orders = rows.draw(np.arange(len(looks)), np.random.default_rng(0))[:2]
    pair.mover.about.fill_(True)  # Which kinds a verb is about is all that only a command tells.
    at = torch.where(orders.things < 0, OBJECTS, orders.things)
    pointing = SURE * F.one_hot(at, OBJECTS + 1).float()
    with torch.no_grad():
        wanted = pair.mover(view, orders).changes
        advice = Advice(pair.mover.command(orders.verbs), pointing)
        assert torch.allclose(pair.move(view, orders, advice).changes, wanted, atol=1e-3)
        unsure = Advice(advice.verb, torch.zeros_like(pointing))
        assert not torch.allclose(pair.move(view, orders, unsure).changes, wanted, atol=1e-2)


def test_every_command_points_at_its_object_or_at_none():
    bank = PhraseBank.of(reversed(COMMANDS))
    found = dict(zip(bank.phrases, fit.objects_of(bank).tolist(), strict=True))
    assert found["pick up the cheese"] == BODY_NAMES.index("cheese")
    assert found["put it on the plate"] == OBJECTS
    assert sorted(found.values()) == [*range(OBJECTS), *[OBJECTS] * (len(COMMANDS) - OBJECTS)]


def test_labels_alone_teach_the_control_where_to_point(monkeypatch):
    monkeypatch.setattr(fit, "chunk_loss", lambda *_: torch.zeros(()))
    started = begun("guided", few(), SETTINGS.model_copy(update={"lr": 3e-3}))
    heard = []
    started.pair.link.register_forward_hook(lambda _, given, out: heard.append((given[2], out)))
    started.run(14)
    bank = PhraseBank.of(COMMANDS)
    told = (heard[-1][0] @ torch.tensor(bank.vectors).T).argmax(-1)
    assert torch.equal(heard[-1][1].pointing.argmax(-1), fit.objects_of(bank)[told])


def test_the_control_hears_the_right_phrase_in_learning_and_the_likeliest_in_acting():
    phrases = torch.eye(20, 384)
    meaning, right = F.normalize(phrases[3:5] + 0.5 * phrases[7:9], dim=-1), torch.tensor([7, 0])
    control, latent = fresh("guided", 0, teaching()), fresh("latent", 0, teaching())
    assert torch.equal(control.passed(meaning, phrases, right), phrases[[7, 0]])
    assert torch.equal(control.passed(meaning, phrases), phrases[3:5])
    assert torch.equal(latent.passed(meaning, phrases, right), meaning)


def test_the_control_acts_by_the_likeliest_phrase():
    pair = fresh("guided", 0, teaching()).eval()
    mind = Mind(pair)
    heard = []
    pair.link.register_forward_hook(lambda _, given, __: heard.append(given[2]))
    seen = teaching().decisions.seen.examples
    arrays = {"images": seen.images[0], "proprioception": seen.senses[0], "objects": NOTHING}
    mind.propose(Observation(step=0, prompt=seen.prompts[0], previous=(), arrays=arrays))
    assert any(np.array_equal(heard[0][0], phrase) for phrase in mind.bank.vectors)
