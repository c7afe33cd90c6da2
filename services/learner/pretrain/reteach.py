"""Teaches the reader of a low level the lexicon as it is now; the hand stays as it was.

`python -m services.learner.pretrain.reteach --out DIR` takes the low level of the project, goes on
with its tagger, fits all else that its reader knows anew, and examines it. Whoever adds a word runs
it; `hld pretrain` makes all from nothing.
"""

import argparse
from pathlib import Path

import torch

from services.learner.pretrain import cards
from services.learner.pretrain.figures import reading
from services.learner.pretrain.lexicon import exam
from services.learner.pretrain.reader_fit import ReaderFitSettings, fit_reader
from services.learner.pretrain.tagger_fit import TaggerFitSettings
from shared.goals.language.encoder import shared_encoder
from shared.policies import checkpoint
from shared.policies.checkpoint import Tensors
from shared.policies.reader.reader import restore

TAGGER = TaggerFitSettings(epochs=4, lr=1e-3)
"""It knows most already."""


def reteach(tensors: Tensors, settings: ReaderFitSettings) -> Tensors:
    """A low level's tensors with those of a reader that was taught anew."""
    encoder = shared_encoder()
    before = restore(tensors, encoder)
    reader = fit_reader(exam()[0], settings, encoder, before.tagger)
    motion = {name: value for name, value in tensors.items() if not name.startswith("reader.")}
    return {**motion, **reader.tensors()}


def main() -> None:
    """Teach, examine, write the checkpoint with its card."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the new checkpoint")
    parser.add_argument("--low-level", type=Path, default=checkpoint.bundled("low_level"))
    parser.add_argument(
        "--phrases", type=int, default=4_000, help="to learn from; 0: examine alone"
    )
    parser.add_argument("--seed", type=int, default=0, help="of what is drawn")
    args = parser.parse_args()
    torch.set_num_threads(1)
    tensors, card = checkpoint.load(args.low_level)
    settings = ReaderFitSettings(phrases=max(1, args.phrases), seed=args.seed, tagger=TAGGER)
    taught = reteach(tensors, settings) if args.phrases else tensors
    checkpoint.save(args.out, taught, card)  # To be examined as it will be loaded.
    made = cards.retaught(card, args.phrases, args.seed, reading(args.out))
    checkpoint.save(args.out, taught, made)


if __name__ == "__main__":
    main()
