"""The low level: a command and what the robot senses become the next motions of both arms.

It is frozen while the high level learns; its hash is compared before and after each round.
"""

from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from shared.errors import PolicyError
from shared.goals.family import Floats, GoalFamily, open_family
from shared.messages.goal import Goal
from shared.policies import checkpoint
from shared.policies.checkpoint import Tensors, sha256_tensors
from shared.policies.geometry import Geometry
from shared.policies.low_net import CHUNK, LowNet, targets

_MEASURES = ("places", "half_heights", "round", "base_x")


class LowLevel:
    """Goal-conditioned policy for both arms; a pure function, safe to share between robots.

    sha256: over all tensors. chunk_steps: actions that `act` gives at once.

    Source: action chunks of Zhao et al. 2023 (arXiv 2304.13705), by regression, without the VAE.
    """

    def __init__(self, net: LowNet, family: GoalFamily | None = None) -> None:
        self._net = net.eval().requires_grad_(False)
        self._family = family or open_family("language")
        self.sha256 = sha256_tensors(self.tensors())
        self.chunk_steps = CHUNK

    @classmethod
    def load(cls, folder: Path, family: GoalFamily | None = None) -> "LowLevel":
        """The low level of a checkpoint.

        Raises:
            PolicyError: the folder holds no low level.
        """
        return cls(build(checkpoint.load(folder)[0]), family)

    def tensors(self) -> Tensors:
        """Copies of all tensors by name."""
        return {name: value.numpy().copy() for name, value in self._net.state_dict().items()}

    def fingerprint(self) -> str:
        """The hash over all tensors as they are in memory now; `sha256` as long as frozen."""
        return sha256_tensors(self.tensors())

    def act(self, proprioception: Floats, objects: Floats, goal: Goal) -> Floats:
        """The next action chunk, [10, 14] float32: joint targets in rad, grippers in m.

        proprioception: [22] float32, objects: [9, 9] float32, as in `Observation`.
        """
        chunk: Floats = self.act_all(proprioception[None], objects[None], (goal,))[0]
        return chunk

    def act_all(self, proprioception: Floats, objects: Floats, goals: tuple[Goal, ...]) -> Floats:
        """`act` for B robots at once: [B, 22], [B, 9, 9] and B goals to [B, 10, 14]."""
        words = torch.from_numpy(self._family.embed(goals))
        with torch.inference_mode():
            both = self._targets(torch.from_numpy(proprioception), torch.from_numpy(objects), words)
        chunk: Floats = both.numpy()
        return chunk

    def completion(self, proprioception: Floats, objects: Floats, goal: Goal) -> float:
        """See `LowLevel.completion` of the rollout.

        Raises:
            PolicyError: always, since this network has no classifier.
        """
        del proprioception, objects
        raise PolicyError(
            f"this low level can't tell whether {goal.text!r} is achieved; set replan=interval"
        )

    def objection(self, goal: Goal, objects: Floats) -> str:
        """None: whatever is said, this network does something."""
        del goal, objects
        return ""

    def _targets(self, proprioception: Tensor, objects: Tensor, words: Tensor) -> Tensor:
        count = len(words)
        arm = torch.arange(2).repeat_interleave(count)
        view = self._net.geometry(proprioception.repeat(2, 1), objects.repeat(2, 1, 1), arm)
        chunks = targets(self._net(view, words.repeat(2, 1)), view.now)
        return torch.cat([chunks[:count], chunks[count:]], -1)


def build(tensors: Tensors) -> LowNet:
    """The network around its tensors.

    Raises:
        PolicyError: the tensors are not a low level's.
    """
    try:
        measures = {name: torch.from_numpy(tensors[f"geometry.{name}"]) for name in _MEASURES}
        net = LowNet(Geometry(measures), width=len(tensors["enter.bias"]))
        net.load_state_dict({name: torch.from_numpy(value) for name, value in tensors.items()})
    except (KeyError, RuntimeError) as error:
        raise PolicyError(f"these tensors are no low level: {error}") from None
    return net


def as_tensors(net: torch.nn.Module) -> Tensors:
    """A network's tensors by name, as arrays."""
    return {name: np.array(value.detach().numpy()) for name, value in net.state_dict().items()}
