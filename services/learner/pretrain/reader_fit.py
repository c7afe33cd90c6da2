"""Teaches the reader a lexicon: which part each word plays, what is asked for, which names are like
which. The sentence encoder stays as it is.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional as F

from services.learner.pretrain.frames import frame_of
from services.learner.pretrain.lexicon import Lexicon
from services.learner.pretrain.tagger_fit import TaggerFitSettings, fit_tagger
from services.learner.pretrain.words import NAMED, Said, Speaker, nouns
from shared.config import Settings
from shared.goals.family import Floats
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.policies.low_net import VERBS
from shared.policies.reader.likeness import FEATURES, Likeness
from shared.policies.reader.meant import ACTS, PLACES
from shared.policies.reader.phrase import take_apart, words_of
from shared.policies.reader.reader import Reader
from shared.policies.reader.tagger import Tagger
from shared.policies.reader.teller import Linear, Teller, features
from shared.workcell.objects import BODY_NAMES, KITCHEN, OBJECT_NAMES, TABLE
from shared.workcell.skills import COMMANDS, SKILLS

Rows = NDArray[np.int64]
EVERY_NOUN = 24
"""Of so many names of places one is told with all ways not to put something there."""
CANONICAL = 0.25
"""The plain words are said far more often than any other; see `Speaker`."""


class ReaderFitSettings(Settings):
    """phrases: drawn to learn from. seed: of what is drawn. *_decay: how small weights are kept."""

    phrases: int = 24_000
    seed: int = 0
    tagger: TaggerFitSettings = TaggerFitSettings()
    acts_decay: float = 1e-4
    names_decay: float = 1e-3
    likeness_decay: float = 1e-3


@dataclass(frozen=True)
class _Named:
    """Known names: texts, their class (the last: none of them), and the group each is of."""

    texts: list[str]
    owners: Rows
    groups: Rows


def fit_reader(
    lexicon: Lexicon,
    settings: ReaderFitSettings,
    encoder: Encoder | None = None,
    start: Tagger | None = None,
) -> Reader:
    """A reader that was taught a lexicon and the canonical commands.

    start: its tagger goes on with what this one knows.
    """
    encoder = encoder or shared_encoder()
    rng = np.random.default_rng(settings.seed)
    speaker = Speaker(lexicon, lexicon, lexicon, rng, CANONICAL)
    said = drawn(speaker, settings.phrases, rng)
    parts, guessed = _fit_parts(said, settings, encoder, start)
    needs = [skill.object or skill.verb for skill in SKILLS]
    reader = Reader(
        COMMANDS,
        np.array([VERBS.index(skill.verb) for skill in SKILLS]),
        np.array([BODY_NAMES.index(name) if name in BODY_NAMES else -1 for name in needs]),
        parts,
        _fit_acts(lexicon, guessed, settings, encoder),
        _fit_names(lexicon, settings, encoder),
        _fit_places(lexicon, settings, encoder),
        encoder,
    )
    return reader.with_encoder(encoder)  # Rounded as it will be when it is loaded.


def drawn(speaker: Speaker, count: int, rng: np.random.Generator) -> list[Said]:
    """Phrases of all kinds; half of them with courtesy or protest, some with a slip."""

    def thing() -> str:
        return str(rng.choice(OBJECT_NAMES))

    kinds: list[tuple[float, Callable[[], Said]]] = [
        (0.30, lambda: speaker.pick(thing())),
        (0.18, lambda: speaker.contrasted(thing(), thing())),
        (0.20, lambda: speaker.put(str(rng.choice(PLACES)))),
        (0.07, lambda: speaker.put(str(rng.choice(PLACES)), thing())),
        (0.06, lambda: speaker.contrasted_put(*map(str, rng.permutation(PLACES)[:2]))),
        (0.03, lambda: speaker.bare_put(str(rng.choice(PLACES)))),
        (0.06, speaker.wait),
        (0.07, speaker.unknown_thing),
        (0.05, speaker.unknown_held),
        (0.05, lambda: speaker.beside_place(thing() if rng.random() < 0.3 else "")),
        (0.09, lambda: speaker.unknown_act(thing())),
        (0.05, lambda: speaker.unknown_place(thing() if rng.random() < 0.3 else "")),
        (0.07, speaker.chat),
        (0.03, speaker.pointing),
        (0.05, lambda: speaker.two(thing(), thing())),
    ]
    shares = np.array([share for share, _ in kinds])
    said = []
    for kind in rng.choice(len(kinds), size=count, p=shares / shares.sum()):
        one = kinds[kind][1]()
        one = speaker.dressed(one) if rng.random() < 0.5 else one
        said.append(speaker.misspelt(one) if rng.random() < 0.05 else one)
    return said


def _fit_parts(
    said: Sequence[Said],
    settings: ReaderFitSettings,
    encoder: Encoder,
    start: Tagger | None,
) -> tuple[Tagger, dict[Said, tuple[int, ...]]]:
    """Tells the part of each word; and how half of the phrases look to one that never saw them."""
    states = encoder.study([one.text for one in said])[1]
    parts = [one.parts for one in said]
    half = len(said) // 2
    green = fit_tagger(states[:half], parts[:half], settings.tagger, settings.seed, start)
    guessed = {
        one: tuple(green.parts(state))
        for one, state in zip(said[half:], states[half:], strict=True)
    }
    return fit_tagger(states, parts, settings.tagger, settings.seed, start), guessed


def _fit_acts(
    lexicon: Lexicon,
    guessed: dict[Said, tuple[int, ...]],
    settings: ReaderFitSettings,
    encoder: Encoder,
) -> Teller:
    """Tells what is asked for: of frames as they are, and as they look when parts are mistaken."""
    seen: dict[tuple[str, int], None] = {}
    for one, guess in guessed.items():
        seen[take_apart(words_of(one.text), guess).frame, ACTS.index(one.act)] = None
    return _fit_teller(_frames(lexicon), [], settings, encoder, settings.acts_decay, tuple(seen))


def _frames(lexicon: Lexicon) -> _Named:
    """What is said for each act; the last one is what nobody here can do."""
    acts, others = lexicon.acts, lexicon.others
    known = [[*acts[act], *acts.get(NAMED.get(act, ""), ())] for act in ACTS[:-1]]
    known[ACTS.index("pick")] = _pointing(known[ACTS.index("pick")])
    named = _named(known, [*_pointing(others["acts"]), *others["said"]])
    return replace(named, texts=[frame_of(text) for text in named.texts])


def _pointing(groups: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """What is said of a thing, and the same of "it"."""
    return [(*group, *(text.replace("{}", "it") for text in group)) for group in groups]


def _fit_names(lexicon: Lexicon, settings: ReaderFitSettings, encoder: Encoder) -> Teller:
    """Learned in both kinds of scene: with the food, and with the dishes and the rubbish."""
    looks, others = lexicon.others["looks"], lexicon.others["things"]
    others = tuple(
        (*group, f"{looks[at % len(looks)][0]} {group[0]}") for at, group in enumerate(others)
    )
    named = _named([lexicon.things[name] for name in OBJECT_NAMES], others)
    scenes = [
        np.array([name in stock for name in OBJECT_NAMES] + [True]) for stock in (KITCHEN, TABLE)
    ]
    return _fit_teller(named, scenes, settings, encoder, settings.names_decay)


def _fit_places(lexicon: Lexicon, settings: ReaderFitSettings, encoder: Encoder) -> Teller:
    """None of them is also what lies next to, under or out of plate, bin and tub.

    Of all that these are called only the regression learns that: of so many texts alike the
    likeness would learn that none of them is always so near.
    """
    ways = [*chain(*lexicon.others["relations"]), *chain(*lexicon.others["removals"])]
    plain = [
        tuple(way.format(noun) for way in ways) for noun in ("the plate", "the bin", "the tub")
    ]
    others = [*lexicon.places["other"], *plain]
    named = _named([lexicon.places[name] for name in PLACES], others)
    called = nouns(lexicon.places)[::EVERY_NOUN]
    more = [(way.format(noun), len(PLACES)) for way in ways for noun in called]
    return _fit_teller(named, [], settings, encoder, settings.names_decay, more)


def _named(known: Sequence[Sequence[tuple[str, ...]]], none: Sequence[tuple[str, ...]]) -> _Named:
    groups = [(row, group) for row, table in enumerate([*known, none]) for group in table]
    return _Named(
        [text for _, group in groups for text in group],
        np.array([row for row, group in groups for _ in group]),
        np.array([number for number, (_, group) in enumerate(groups) for _ in group]),
    )


def _fit_teller(
    named: _Named,
    scenes: Sequence[NDArray[np.bool_]],
    settings: ReaderFitSettings,
    encoder: Encoder,
    decay: float,
    more: Sequence[tuple[str, int]] = (),
) -> Teller:
    """Learned from known texts; the regression from `more` texts with their class too.

    scenes: which classes there may be at a time; none: all.
    """
    vectors = encoder.study(named.texts)[0]
    texts = [*named.texts, *(text for text, _ in more)]
    rest = encoder.study(texts[len(vectors) :])[0]
    every = np.concatenate([vectors, rest])
    x = np.stack([features(*one) for one in zip(texts, every, strict=True)])
    y = np.array([*named.owners, *(owner for _, owner in more)])
    classes = int(named.owners.max()) + 1
    linear = _softmax_regression(x, y, classes, decay)
    masks = scenes or [np.ones(classes, np.bool_)]
    return Teller(linear, _fit_likeness(named, vectors, masks, settings.likeness_decay))


def _fit_likeness(
    named: _Named, vectors: Floats, scenes: Sequence[NDArray[np.bool_]], decay: float
) -> Likeness:
    """Weighs the features so that each known text would be told by the texts of other groups."""
    start = Likeness(named.texts, named.owners, vectors, np.zeros((2, FEATURES + 1), np.float32))
    apart = named.groups[:, None] == named.groups[None, :]
    x = np.stack(
        [start.features(*one) for one in zip(named.texts, vectors, apart, strict=True)]
    )  # [P, C + 1, F]
    weights = _weigh(x, named.owners, scenes, decay)
    return Likeness(named.texts, named.owners, vectors, weights)


def _weigh(x: Floats, owners: Rows, scenes: Sequence[NDArray[np.bool_]], decay: float) -> Floats:
    """Conditional logit: [2, F + 1] weights of classes and of none of them, by LBFGS."""
    mean, spread = x.mean((0, 1)), x.std((0, 1)) + 1e-6
    seen, right = torch.from_numpy((x - mean) / spread), torch.from_numpy(owners)
    weights = torch.zeros(2, x.shape[-1] + 1, requires_grad=True)
    masks = [torch.from_numpy(scene) for scene in scenes]

    def loss() -> Tensor:
        logits = torch.cat(
            [seen[:, :-1] @ weights[0, :-1], seen[:, -1:] @ weights[1, :-1] + weights[1, -1]], 1
        )
        lost = [
            F.cross_entropy(logits.masked_fill(~mask, -30.0)[mask[right]], right[mask[right]])
            for mask in masks
        ]
        return torch.stack(lost).sum() + decay * weights.square().sum()

    _minimise([weights], loss)
    slopes = weights.detach().numpy()[:, :-1] / spread
    offsets = weights.detach().numpy()[:, -1] - slopes @ mean
    return np.concatenate([slopes, offsets[:, None]], 1).astype(np.float32)


def _softmax_regression(x: Floats, y: Rows, classes: int, decay: float) -> Linear:
    """Multinomial logistic regression by LBFGS."""
    seen, right = torch.from_numpy(x), torch.from_numpy(y)
    weights = torch.zeros(classes, x.shape[1], requires_grad=True)
    bias = torch.zeros(classes, requires_grad=True)

    def loss() -> Tensor:
        lost = F.cross_entropy(F.linear(seen, weights, bias), right)
        return lost + decay * weights.square().sum()

    _minimise([weights, bias], loss)
    return Linear(weights.detach().numpy(), bias.detach().numpy())


def _minimise(weights: list[Tensor], loss: Callable[[], Tensor], steps: int = 100) -> None:
    optimizer = torch.optim.LBFGS(weights, max_iter=steps, line_search_fn="strong_wolfe")

    def closure() -> float:
        optimizer.zero_grad()
        lost = loss()
        lost.backward()  # type: ignore[no-untyped-call]
        return float(lost.detach())

    optimizer.step(closure)  # type: ignore[no-untyped-call]
