"""The high level: looks, reads the prompt, and proposes every command it knows, best first."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.messages.decision import Proposal
from shared.messages.goal import LanguageGoal
from shared.messages.observation import Observation
from shared.messages.policy import PolicyAnnouncement, Version
from shared.policies import checkpoint
from shared.policies.checkpoint import Setting, Tensors
from shared.policies.high_net import HighLevelNet, Question
from shared.policies.reading import past_vectors

BASE_VERSION = Version(1, 0)


class HighLevel:
    """A version of the high level: a network, the phrases that belong to it, and its number.

    Safe to be asked from several threads, as long as nobody trains `net` meanwhile.
    """

    def __init__(
        self,
        net: HighLevelNet,
        bank: PhraseBank,
        version: Version,
        encoder: Encoder | None = None,
    ) -> None:
        self.net, self.bank, self.version = net.eval(), bank, version
        self._encoder = encoder or shared_encoder()
        self._phrases = torch.tensor(bank.vectors)
        self._goals = tuple(LanguageGoal(text=phrase) for phrase in bank.phrases)

    @classmethod
    def load(cls, folder: Path) -> "HighLevel":
        """The high level of a checkpoint.

        Raises:
            PolicyError: the folder holds no high level.
        """
        tensors, card = checkpoint.load(folder)
        phrases = str(card.settings.get("bank", "")).split("\n")
        net = build_net(card.settings, tensors)
        return cls(net, PhraseBank.of(phrases), Version.parse(card.version))

    @classmethod
    def build(
        cls, announcement: PolicyAnnouncement, tensors: Mapping[str, NDArray[Any]]
    ) -> "HighLevel":
        """The version that a learner announced, from the tensors that it published.

        Raises:
            PolicyError: the tensors don't fit the announcement or this network.
        """
        named = {ref.name for ref in announcement.tensors}
        if named != set(tensors):
            raise PolicyError(
                f"{announcement.version} announces tensors {sorted(named)}, "
                f"but {sorted(tensors)} came"
            )
        net = build_net(announcement.settings, tensors)
        return cls(net, PhraseBank.of(announcement.bank), announcement.version)

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8]] = ()
    ) -> tuple[Proposal, ...]:
        """Every phrase of the bank with its probability, best first."""
        del past  # Unused: this network looks at the present only.
        images = torch.from_numpy(np.ascontiguousarray(observation.arrays["images"]))
        previous = past_vectors(self._encoder, [observation.previous], self.net.history)
        prompt = self._encoder.embed([observation.prompt])
        question = Question(images[None], torch.from_numpy(prompt), torch.from_numpy(previous))
        with torch.inference_mode():
            logits = self.net.scores(self.net(question), self._phrases)[0]
            shares = torch.softmax(logits.double(), -1).numpy()
        order = np.argsort(-shares, kind="stable")
        return tuple(Proposal(goal=self._goals[row], score=float(shares[row])) for row in order)

    def tensors(self) -> Tensors:
        """Copies of all tensors by name."""
        state = self.net.state_dict()
        return {name: np.array(value.detach().numpy()) for name, value in state.items()}

    def settings(self) -> dict[str, Setting]:
        """What `build` needs besides the tensors and the bank."""
        return {"history": self.net.history, "reading": self.net.reading}


def build_net(settings: Mapping[str, Setting], tensors: Mapping[str, NDArray[Any]]) -> HighLevelNet:
    """The network around its tensors.

    Raises:
        PolicyError: a setting is missing, or the tensors are not this network's.
    """
    try:
        net = HighLevelNet(int(settings["history"]), int(settings["reading"]))
        net.load_state_dict({name: torch.tensor(value) for name, value in tensors.items()})
    except (KeyError, RuntimeError) as error:
        raise PolicyError(f"these tensors are no high level: {error}") from None
    return net
