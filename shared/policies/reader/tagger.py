"""Which part each word of a phrase plays, told by what the words mean where they stand.

Source: a bidirectional GRU (Cho et al. 2014, arXiv 1406.1078) over frozen BERT states.
"""

from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional as F
from torch.nn.utils.rnn import pack_padded_sequence, pad_packed_sequence, pad_sequence

from shared.goals.family import Floats
from shared.policies.checkpoint import Tensors
from shared.policies.reader.phrase import PARTS

DROPOUT = 0.3


class Tagger(nn.Module):
    """States [W, S] of a phrase's words to a part for each; narrow, hidden: widths within.

    mean, spread: [S], of the states that it learned from.
    """

    mean: Tensor
    spread: Tensor

    def __init__(self, mean: Tensor, spread: Tensor, narrow: int = 96, hidden: int = 64) -> None:
        super().__init__()
        self.register_buffer("mean", mean)
        self.register_buffer("spread", spread)
        self.enter = nn.Linear(len(mean), narrow)
        self.along = nn.GRU(narrow, hidden, batch_first=True, bidirectional=True)
        self.leave = nn.Linear(2 * hidden, len(PARTS))
        self.drop = nn.Dropout(DROPOUT)

    def forward(self, phrases: Sequence[Tensor]) -> Tensor:
        """Logits [B, W, parts] of phrases, each [w, S] and none empty; W words the longest."""
        states = (pad_sequence(list(phrases), batch_first=True) - self.mean) / self.spread
        entered = self.drop(F.gelu(self.enter(self.drop(states))))
        lengths = torch.tensor([len(phrase) for phrase in phrases])
        packed = pack_padded_sequence(entered, lengths, batch_first=True, enforce_sorted=False)
        passed, _ = pad_packed_sequence(self.along(packed)[0], batch_first=True)
        logits: Tensor = self.leave(self.drop(passed))
        return logits

    def parts(self, states: Floats) -> list[int]:
        """The part of each word of one phrase."""
        with torch.inference_mode():
            return [int(part) for part in self([torch.from_numpy(states)])[0].argmax(-1)]

    def tensors(self, prefix: str) -> Tensors:
        """All that `restore` needs, by name."""
        return {
            f"{prefix}.{name}": value.numpy().copy() for name, value in self.state_dict().items()
        }


def restore(tensors: Tensors, prefix: str) -> Tagger:
    """What `Tagger.tensors` gave.

    Raises:
        KeyError: something is missing.
        RuntimeError: it is no tagger's.
    """
    own = {
        name.removeprefix(f"{prefix}."): torch.from_numpy(np.ascontiguousarray(value))
        for name, value in tensors.items()
        if name.startswith(f"{prefix}.")
    }
    narrow, hidden = len(own["enter.bias"]), own["leave.weight"].shape[1] // 2
    tagger = Tagger(own["mean"], own["spread"], narrow, hidden)
    tagger.load_state_dict(own)
    return tagger.eval().requires_grad_(False)
