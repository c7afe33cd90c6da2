"""The high level: looks, reads the prompt, and proposes what to do next, best first."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from shared.errors import PolicyError
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.messages.decision import Proposal
from shared.messages.goal import LanguageGoal
from shared.messages.observation import Observation
from shared.messages.policy import PolicyAnnouncement, Version
from shared.policies import checkpoint
from shared.policies.checkpoint import Setting, Tensors
from shared.policies.examples import PIXELS
from shared.policies.high_net import SENSES, VIEWS, Answer, HighLevelNet, Question
from shared.policies.reading import halved, past_vectors, read_words
from shared.policies.wishes import Words

BASE_VERSION = Version(1, 0)
REMEMBERED = 256
T = TypeVar("T")

Head = Literal["bank", "text"]
"""Which head answers: every phrase of the bank is scored, or phrases are made word by word."""


class HighLevel:
    """A version of the high level: a network, the phrases that belong to it, and its number.

    head: which of the network's two heads answers `propose`.
    Safe to be asked from several threads. Once asked it remembers what prompts want: where `net` is
    trained on, it needs another HighLevel.
    """

    def __init__(
        self,
        net: HighLevelNet,
        bank: PhraseBank,
        version: Version,
        encoder: Encoder | None = None,
        head: Head = "bank",
    ) -> None:
        self.net, self.bank, self.version, self.head = net.eval(), bank, version, head
        self._encoder = encoder or shared_encoder()
        self._phrases = torch.tensor(bank.vectors)
        self._goals = tuple(LanguageGoal(text=phrase) for phrase in bank.phrases)
        self._read: OrderedDict[str, Words] = OrderedDict()
        self._wished: OrderedDict[str, Tensor] = OrderedDict()
        self._lock = threading.Lock()

    @classmethod
    def load(cls, folder: Path, head: Head = "bank") -> "HighLevel":
        """The high level of a checkpoint.

        Raises:
            PolicyError: the folder holds no high level.
        """
        tensors, card = checkpoint.load(folder)
        phrases = str(card.settings.get("bank", "")).split("\n")
        net = build_net(card.settings, tensors)
        return cls(net, PhraseBank.of(phrases), Version.parse(card.version), head=head)

    @classmethod
    def build(
        cls,
        announcement: PolicyAnnouncement,
        tensors: Mapping[str, NDArray[Any]],
        head: Head = "bank",
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
        return cls(net, PhraseBank.of(announcement.bank), announcement.version, head=head)

    def check_memory(self, looks: int, history: int) -> None:
        """Whether it makes use of so many observations and previous commands.

        Raises:
            PolicyError: it would be shown more than its network has room for.
        """
        for name, asked, most in (
            ("looks", looks, self.net.looks),
            ("history", history, self.net.history),
        ):
            if asked > most:
                raise PolicyError(
                    f"this high level was trained with {name} of {most} at most: "
                    f"set {name} to {most} or less, not {asked}"
                )

    def propose(
        self, observation: Observation, past: Sequence[NDArray[np.uint8] | None] = ()
    ) -> tuple[Proposal, ...]:
        """Goals with their probabilities, best first.

        From the bank's head all phrases of the bank; from the text head the most probable phrases
        that it can make, whose probabilities sum to at most 1.
        past: earlier looks, as in `rollout.robot.HighLevel`; the last ones are used, and fewer do.
            None: one that is not here; its place is masked, and the others keep theirs.

        Raises:
            PolicyError: the observation has another number of views or senses.
        """
        with torch.inference_mode():
            question, wishes = self.question(observation, past), self._wishes(observation.prompt)
            answer = self.net.decide(self.net.see(question.images), wishes, question)
            if self.head == "text":
                return self._made(answer)
            return self.scored(answer)

    def scored(self, answer: Answer) -> tuple[Proposal, ...]:
        """Every phrase of the bank with its probability, best first."""
        logits = self.net.scores(answer.meaning, self._phrases)[0]
        shares = torch.softmax(logits.double(), -1).numpy()
        order = np.argsort(-shares, kind="stable")
        return tuple(Proposal(goal=self._goals[row], score=float(shares[row])) for row in order)

    def _made(self, answer: Answer) -> tuple[Proposal, ...]:
        phrases = self.net.text.phrases(answer.thought)
        return tuple(Proposal(goal=LanguageGoal(text=text), score=share) for text, share in phrases)

    def question(
        self, observation: Observation, past: Sequence[NDArray[np.uint8] | None] = ()
    ) -> Question:
        """An observation as the network is asked about it; as for `propose`."""
        images = np.ascontiguousarray(observation.arrays["images"])
        senses = np.array(observation.arrays["proprioception"], np.float32)
        if (len(images), *senses.shape) != (VIEWS, SENSES):
            raise PolicyError(
                f"this high level sees {VIEWS} views and feels {SENSES} numbers; it was shown "
                f"{len(images)} views and proprioception of shape {senses.shape}"
            )
        looks = [*[None] * self.net.looks, *past, images][-self.net.looks :]
        seen = np.array([look is not None for look in looks])
        glimpses = np.zeros((len(looks), VIEWS, PIXELS // 2, PIXELS // 2, 3), np.uint8)
        glimpses[seen] = halved(np.stack([look for look in looks if look is not None]))
        previous = past_vectors(self._encoder, [observation.previous], self.net.history)
        return Question(
            torch.from_numpy(images)[None],
            torch.from_numpy(glimpses)[None],
            torch.from_numpy(seen)[None],
            torch.from_numpy(senses)[None],
            self._words(observation.prompt),
            torch.from_numpy(previous),
        )

    def _words(self, prompt: str) -> Words:
        """A prompt's words; an episode asks with the same ones again and again."""
        return self._remembered(self._read, prompt, lambda: read_words(self._encoder, [prompt]))

    def _wishes(self, prompt: str) -> Tensor:
        """What a prompt wants of each slot."""
        words = self._words(prompt)
        return self._remembered(self._wished, prompt, lambda: self.net.wish(words))

    def _remembered(self, known: OrderedDict[str, T], prompt: str, make: Callable[[], T]) -> T:
        with self._lock:
            if prompt not in known:
                known[prompt] = make()
            while len(known) > REMEMBERED:
                known.popitem(last=False)
            return known[prompt]

    def tensors(self) -> Tensors:
        """Copies of all tensors by name."""
        state = self.net.state_dict()
        return {name: np.array(value.detach().numpy()) for name, value in state.items()}

    def settings(self) -> dict[str, Setting]:
        """What `build` needs besides the tensors and the bank."""
        net = self.net
        return {"history": net.history, "looks": net.looks, "words": " ".join(net.text.words)}


def build_net(settings: Mapping[str, Setting], tensors: Mapping[str, NDArray[Any]]) -> HighLevelNet:
    """The network around its tensors.

    Raises:
        PolicyError: a setting is missing, or the tensors are not this network's.
    """
    try:
        words = tuple(str(settings["words"]).split())
        net = HighLevelNet(int(settings["history"]), int(settings["looks"]), words)
        net.load_state_dict({name: torch.tensor(value) for name, value in tensors.items()})
    except (KeyError, RuntimeError) as error:
        raise PolicyError(f"these tensors are no high level: {error}") from None
    return net
