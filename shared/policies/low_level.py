"""The low level: a command and what the robot senses become the next motions of both arms.

It is frozen while the high level learns; its hash is compared before and after each round.
"""

from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from shared.errors import PolicyError
from shared.goals.family import Floats
from shared.goals.language.encoder import shared_encoder
from shared.messages.goal import Goal
from shared.policies import checkpoint
from shared.policies.checkpoint import Tensors, sha256_tensors
from shared.policies.geometry import MEASURES, Geometry, View
from shared.policies.low_net import CHUNK, CLOSED_M, OPEN_M, LowNet, Motion, Orders, targets
from shared.policies.reader import reader
from shared.policies.reader.claims import elsewhere
from shared.policies.reader.clauses import in_turn
from shared.policies.reader.lying import APART_M, cover_of, furthest, place_of
from shared.policies.reader.meant import LEAST_ACT, PUTS, THINGS, Reading
from shared.policies.reader.reader import Reader, Sentences
from shared.policies.reader.weighed import LEAST_NAME
from shared.policies.tokens import OPEN_GAP_M
from shared.policies.wishes import SLOTS

ARMS = ("left", "right")
LEAST_HELD = 0.05
"""What is in the hand is meant by a name that could be many things, "the slice", from here on."""


class LowLevel:
    """Goal-conditioned policy for both arms; a pure function, safe to share between robots.

    sha256: over all tensors. chunk_steps: actions that `act` gives at once.

    Source: action chunks of Zhao et al. 2023 (arXiv 2304.13705), by regression, without the VAE.
    """

    def __init__(self, net: LowNet, words: Reader) -> None:
        self._net = net.eval().requires_grad_(False)
        self.reader = words
        self.sha256 = sha256_tensors(self.tensors())
        self.chunk_steps = CHUNK

    @classmethod
    def load(cls, folder: Path, encoder: Sentences | None = None) -> "LowLevel":
        """The low level of a checkpoint.

        Raises:
            PolicyError: the folder holds no low level.
        """
        tensors = checkpoint.load(folder)[0]
        return cls(build(tensors), reader.restore(tensors, encoder or shared_encoder()))

    def tensors(self) -> Tensors:
        """Copies of all tensors by name."""
        return {**as_tensors(self._net), **self.reader.tensors()}

    def fingerprint(self) -> str:
        """The hash over all tensors as they are in memory now; `sha256` as long as frozen."""
        return sha256_tensors(self.tensors())

    def act(self, proprioception: Floats, objects: Floats, goal: Goal) -> Floats:
        """The next action chunk, [10, 14] float32: joint targets in rad, grippers in m.

        proprioception: [22] float32, objects: [18, 9] float32, as in `Observation`. Where it
        objects to the goal the arms stay as they are.
        """
        chunk: Floats = self.act_all(proprioception[None], objects[None], (goal,))[0]
        return chunk

    def act_all(self, proprioception: Floats, objects: Floats, goals: tuple[Goal, ...]) -> Floats:
        """`act` for B robots at once: [B, 22], [B, 18, 9] and B goals to [B, 10, 14]."""
        rows = [
            self._understood(goal, objects[at], proprioception[at]) for at, goal in enumerate(goals)
        ]
        with torch.inference_mode():
            both = self._motion(proprioception, objects, self._orders(rows))[0]
        chunk: Floats = both.numpy()
        for at, row in enumerate(rows):
            if row is None:
                chunk[at] = _still(proprioception[at])
        return chunk

    def completion(self, proprioception: Floats, objects: Floats, goal: Goal) -> float:
        """See `LowLevel.completion` of the rollout; 0 for a goal that it objects to."""
        row = self._understood(goal, objects, proprioception)
        if row is None:
            return 0.0
        with torch.inference_mode():
            done = self._motion(proprioception[None], objects[None], self._orders([row]))[1]
        return float(done[0])

    def can(self, goal: Goal, objects: Floats) -> bool:
        """Whether it understands the goal and the scene has what it is about."""
        return self._understood(goal, objects) is not None

    def objection(self, proprioception: Floats, objects: Floats, goal: Goal) -> str:
        """Why it can't do what a person says, with what is in the hands; "" if it can."""
        held = self._held(proprioception, objects)
        reading, why = self._read(goal.text, objects, apart_m=APART_M), ""
        if reading.why:
            why = f"{goal.text!r} {reading.why}; nearest it knows"
        elif reading.command is None:
            why = f"the low level doesn't understand {goal.text!r}; nearest it knows"
        elif reading.first and _unheld(reading, held):
            why = f"{goal.text!r} {in_turn(reading.first)}; nearest"
        elif missing := (
            self._missing(reading, objects, held)
            or self._other_hand(reading.arm, proprioception, objects)
        ):
            command = self.reader.commands[reading.command]
            why = f"{command!r} can't be done here, since {missing}; nearest"
        if not why:
            return ""
        nearest = self.nearest(proprioception, objects, goal)
        return f"{why}: {', '.join(repr(text) for text, _ in nearest)}"

    def nearest(
        self, proprioception: Floats, objects: Floats, goal: Goal
    ) -> list[tuple[str, float]]:
        """The commands that a goal is nearest to, of those possible now, and their scores; first
        the one that it means, if that is possible."""
        empty = not self._held(proprioception, objects).any()
        reading = self._read(goal.text, objects)
        return self.reader.nearest(goal.text, _present(objects), empty, reading)

    def anywhere(self) -> tuple[Floats, Floats]:
        """What it would sense, [22] and [18, 9], where all is there that a scene can have."""
        return np.zeros(22, np.float32), np.ones((SLOTS, 9), np.float32)

    def commands(self, objects: Floats) -> list[str]:
        """What it knows and could do with what is in the scene, whatever is in the hands."""
        can = self.reader.possible(_present(objects))
        return [text for text, possible in zip(self.reader.commands, can, strict=True) if possible]

    def _held(self, proprioception: Floats, objects: Floats) -> NDArray[np.bool_]:
        """[15] What is in the hands."""
        seen = torch.from_numpy(proprioception)[None], torch.from_numpy(objects)[None]
        held: NDArray[np.bool_] = self._net.geometry.held(*seen)[0].numpy()
        return held

    def _other_hand(self, arm: str, proprioception: Floats, objects: Floats) -> str:
        """Why an arm can't put what is held, "" if it can or none is named."""
        seen = torch.from_numpy(proprioception)[None], torch.from_numpy(objects)[None]
        full = dict(zip(ARMS, self._net.geometry.grips(*seen)[0].amax(1).tolist(), strict=True))
        return "" if not arm or full[arm] else f"the {arm} hand is empty: leave the hand out"

    def _missing(self, reading: Reading, objects: Floats, held: NDArray[np.bool_]) -> str:
        """Why a command that was understood can't be done now; "" if it can."""
        row = reading.command
        assert row is not None
        if not self._possible(row, _present(objects)):
            return "that isn't in the scene"
        if row in PUTS:
            return _unheld(reading, held) or self._not_there(reading, objects, held)
        if reading.fit.side and held[[*reading.fit.rows]].any():
            return "it fits what is in the hand too: say its name"
        return self._buried(row, objects, held) if row < THINGS and not held[row] else ""

    def _not_there(self, reading: Reading, objects: Floats, held: NDArray[np.bool_]) -> str:
        """Why nothing can be put on a thing that is named; "" if that lies where it is put."""
        there = place_of(objects)
        assert reading.command is not None
        for things in reading.onto:
            fixture = self.reader.things[reading.command]
            if not (things & ~held & (there == fixture)).any():
                names = [self.reader.commands[row].split()[-1] for row in np.flatnonzero(things)]
                return elsewhere(names, self.reader.commands[reading.command])
        return ""

    def _buried(self, row: int, objects: Floats, held: NDArray[np.bool_]) -> str:
        """What lies on a thing; "" if it is free."""
        heights = self._net.geometry.sizes[:, 2].numpy()
        cover = cover_of(row, objects, held, heights)
        if cover is None:
            return ""
        first = self.reader.commands[cover]
        return f"the {first.rsplit(maxsplit=1)[1]} lies on it: {first!r} first"

    def meaning(self, goal: Goal, objects: Floats) -> str | None:
        """The command that it takes a goal for in this scene; None if it understands none."""
        row = self._read(goal.text, objects).command
        return None if row is None else self.reader.commands[row]

    def options(self, goal: Goal, objects: Floats) -> tuple[str, ...]:
        """The commands that a goal fits alike in this scene; none where it means one or nothing."""
        fit = self.reader.read(goal.text, _present(objects)).fit
        return tuple(self.reader.commands[row] for row in fit.rows)

    def _read(self, text: str, objects: Floats, apart_m: float = 0.0) -> Reading:
        """A phrase in a scene, where sides tell things apart that it fits alike."""
        reading = self.reader.read(text, _present(objects))
        fit = reading.fit
        outside = place_of(objects) < 0
        rows = [row for row in fit.rows if outside[row]] or list(fit.rows)
        if not fit.side or (fit.two and len(rows) != 2):
            return reading
        row = furthest(rows, fit.side, objects, apart_m)
        if row is None:
            return reading
        scores = reading.scores.copy()
        scores[[*fit.rows]] = 0.0
        scores[row] = reading.scores[[*fit.rows]].sum()  # It has the share of all that fit.
        return reading._replace(command=row, why="", scores=scores)

    def _understood(
        self, goal: Goal, objects: Floats, proprioception: Floats | None = None
    ) -> int | None:
        """The command that a goal means, None where there is an objection. Of things told apart by
        a side the one in the hand is meant: it lay there before."""
        reading = self._read(goal.text, objects)
        row = reading.command
        if reading.fit.side and proprioception is not None:
            held = self._held(proprioception, objects)
            row = next((at for at in reading.fit.rows if held[at]), row)
        return row if row is not None and self._possible(row, _present(objects)) else None

    def _possible(self, row: int, there: NDArray[np.bool_]) -> bool:
        return bool(self.reader.possible(there)[row])

    def _orders(self, rows: list[int | None]) -> Orders:
        """Of each robot; an objected goal is computed as the first command, and not used."""
        known = np.array([row or 0 for row in rows])
        verbs, things = self.reader.verbs[known], self.reader.things[known]
        held = things < self._net.geometry.sizes.shape[0]  # Fixtures are no objects.
        return Orders(torch.from_numpy(verbs), torch.from_numpy(np.where(held, things, -1)))

    def _motion(
        self, proprioception: Floats, objects: Floats, orders: Orders
    ) -> tuple[Tensor, Tensor]:
        """Targets [B, 10, 14] and the probability that the command is achieved, [B]."""
        count = len(orders.verbs)
        arm = torch.arange(2).repeat_interleave(count)
        seen = torch.from_numpy(proprioception).repeat(2, 1)
        view = self._net.geometry(seen, torch.from_numpy(objects).repeat(2, 1, 1), arm)
        motion = self.moved(view, Orders(*(part.repeat(2) for part in orders)))
        chunks = targets(motion.changes, view.now)
        done = torch.sigmoid(motion.done.reshape(2, count).mean(0))
        return torch.cat([chunks[:count], chunks[count:]], -1), done

    def moved(self, view: View, orders: Orders) -> Motion:
        """What the network does; where more is known than orders, it comes in here."""
        motion: Motion = self._net(view, orders)
        return motion


def _present(objects: Floats) -> NDArray[np.bool_]:
    """[18] What is in the scene: the rows of absent bodies are zero."""
    there: NDArray[np.bool_] = np.abs(objects).max(-1) > 0
    return there


def _unheld(reading: Reading, held: NDArray[np.bool_]) -> str:
    """Why nothing can be put, or not what was named; "" if it can."""
    if not held.any():
        return "nothing is in the hands"
    for thing in reading.things:
        likely = float(thing[held].sum())
        if likely < LEAST_HELD:
            return "what it names is not what is in the hand"
        if likely < LEAST_NAME and thing.max() >= LEAST_ACT:
            return "what it names is hardly what is in the hand: call that 'it'"
    return ""


def _still(proprioception: Floats) -> Floats:
    """Stay as you are, [10, 14]: joints where they are, grippers open or closed as they are."""
    now = proprioception[:14].copy()
    gaps = now[[6, 13]]
    now[[6, 13]] = np.where(gaps < OPEN_GAP_M, CLOSED_M, OPEN_M)
    chunk: Floats = np.repeat(now[None], CHUNK, 0)
    return chunk


def build(tensors: Tensors) -> LowNet:
    """The network around its tensors.

    Raises:
        PolicyError: the tensors are not a low level's.
    """
    own = {name: value for name, value in tensors.items() if not name.startswith("reader.")}
    try:
        measures = {name: torch.from_numpy(tensors[f"geometry.{name}"]) for name in MEASURES}
        net = LowNet(Geometry(measures), width=len(tensors["enter.bias"]))
        net.load_state_dict({name: torch.from_numpy(value) for name, value in own.items()})
    except (KeyError, RuntimeError) as error:
        raise PolicyError(f"these tensors are no low level: {error}") from None
    return net


def as_tensors(net: torch.nn.Module) -> Tensors:
    """A network's tensors by name, as arrays."""
    return {name: np.array(value.detach().numpy()) for name, value in net.state_dict().items()}
