"""How well phrases are read whose words were never taught: cross-validation over the lexicon.

`python -m services.learner.pretrain.reading_exam --report r.json` trains a reader on four folds of
the words, tries phrases with words of the fifth, and does so for each fold and seed.
"""

import argparse
import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from services.learner.pretrain.everyday import writings
from services.learner.pretrain.lexicon import FOLDS, Lexicon, exam, fold
from services.learner.pretrain.reader_fit import ReaderFitSettings, fit_reader
from services.learner.pretrain.reading_figures import (
    HEARD,
    Answer,
    Question,
    figures,
    rates,
    table,
)
from services.learner.pretrain.words import Said, Speaker
from shared.goals.family import Floats
from shared.goals.language.encoder import Encoder, shared_encoder
from shared.policies.reader.meant import PLACES
from shared.policies.reader.phrase import words_of
from shared.policies.reader.reader import Reader
from shared.workcell.objects import BODY_NAMES, KITCHEN, OBJECT_NAMES, TABLE, Stock
from shared.workcell.skills import (
    COMMANDS,
    parse,
)

STOCKS = (KITCHEN, TABLE)


class Studied:
    """An encoder that reads many sentences at once before they are asked for."""

    def __init__(self, encoder: Encoder) -> None:
        self._encoder = encoder
        self._vectors: dict[str, Floats] = {}
        self._states: dict[str, Floats] = {}

    def study(self, sentences: Iterable[str]) -> None:
        """Read them."""
        texts = list(dict.fromkeys(sentences))
        if not texts:
            return
        vectors, states = self._encoder.study(texts)
        self._vectors |= dict(zip(texts, vectors, strict=True))
        self._states |= dict(zip(texts, states, strict=True))

    def embed(self, sentences: Iterable[str]) -> Floats:
        """See `Encoder.embed`."""
        texts = list(sentences)
        self.study([text for text in texts if text not in self._vectors])
        return np.stack([self._vectors[text] for text in texts])

    def is_word(self, text: str) -> bool:
        """See `Encoder.is_word`."""
        return self._encoder.is_word(text)

    def states(self, sentence: str) -> Floats:
        """See `Encoder.states`."""
        if sentence not in self._states:
            self.study([sentence])
        return self._states[sentence]


def ask(reader: Reader, questions: Sequence[Question], encoder: Encoder) -> list[Answer]:
    """How a reader reads them; a command about what is missing in the scene is a refusal."""
    studied = Studied(encoder)
    reader = reader.with_encoder(studied)
    texts = [reader.spelt(one.said.text) for one in questions]
    studied.study(texts)
    studied.study(part for text in texts for part in reader.apart(text).texts())
    answers = []
    for question in questions:
        there = present(question.stock)
        row = reader.read(question.said.text, there).command
        can = row is not None and bool(reader.possible(there)[row])
        answers.append(Answer(question, COMMANDS[row] if row is not None and can else ""))
    return answers


def present(stock: Stock) -> NDArray[np.bool_]:
    """[18] What is in the scene."""
    return np.array([name in stock for name in BODY_NAMES])


class Examiner:
    """Draws questions: known words and unheard ones are put together as the kind says."""

    def __init__(self, known: Lexicon, unheard: Lexicon, seed: int) -> None:
        self._rng = rng = np.random.default_rng(seed)
        self._known = known
        self._speakers = {
            HEARD: Speaker(known, known, known, rng),
            "new verb": Speaker(unheard, known, known, rng),
            "new name": Speaker(known, unheard, known, rng),
            "new verb and name": Speaker(unheard, unheard, known, rng),
            "new courtesy": Speaker(known, known, unheard, rng),
        }

    def questions(self, each: int) -> list[Question]:
        """`each` questions of a kind about each thing, three times as many of what has none."""
        asked: list[Question] = []
        for stock in STOCKS:
            names = [name for name in OBJECT_NAMES if name in stock]
            for kind, speaker in self._speakers.items():
                for name in names * each:
                    asked += self._commands(kind, speaker, name, stock)
                asked += [self._put(kind, speaker, stock) for _ in range(12 * each)]
                if kind != "new name":  # To wait there is no name.
                    asked.append(self._question(kind, speaker.wait(), stock, dress=True))
            for name in names * each:
                asked += self._hard(name, names, stock)
        return asked

    def _commands(self, kind: str, speaker: Speaker, name: str, stock: Stock) -> list[Question]:
        """A pick, and every third time a put that names what is held."""
        said = [speaker.pick(name, framed="verb" in kind)]
        if self._rng.random() < 1 / 3:
            said.append(speaker.put(self._target(stock), name))
        return [self._question(kind, one, stock, dress=True) for one in said]

    def _put(self, kind: str, speaker: Speaker, stock: Stock) -> Question:
        said = speaker.put(self._target(stock), placed="name" in kind)
        return self._question(kind, said, stock, dress=True)

    def _target(self, stock: Stock) -> str:
        places = [place for place in PLACES if place == "down" or place in stock]
        return str(self._rng.choice(places))

    def _question(self, kind: str, said: Said, stock: Stock, dress: bool = False) -> Question:
        speaker = self._speakers[kind if kind in self._speakers else HEARD]
        if dress and (kind == "new courtesy" or self._rng.random() < 0.5):
            said = speaker.dressed(said)
        return Question(kind, said, stock, "name" in kind and self._strange(said))

    def _strange(self, said: Said) -> bool:
        """Whether no word of the thing's name is in a name that was taught for it."""
        thing = said.meant.removeprefix("pick up the ")
        if thing not in self._known.things:
            return False
        taught = {
            word for group in self._known.things[thing] for text in group for word in words_of(text)
        }
        words = {
            word for word, part in zip(words_of(said.text), said.parts, strict=True) if part == 2
        }
        return not (words - {"the", "that", "this", "a", "my"}) & taught

    def _hard(self, name: str, names: list[str], stock: Stock) -> list[Question]:
        """What is hard to read, and what is to be refused."""
        rng = self._rng
        other = str(rng.choice([one for one in names if one != name]))
        missing = str(rng.choice([one for one in OBJECT_NAMES if one not in stock]))
        known, verb, noun = (self._speakers[kind] for kind in (HEARD, "new verb", "new name"))
        absent = known.pick(missing)._replace(meant="")
        return [
            Question("not this but that", known.contrasted(name, other), stock),
            Question("a slip of the finger", known.misspelt(known.pick(name)), stock),
            Question("refuse: unknown thing", noun.unknown_thing(), stock),
            Question("refuse: unknown act", verb.unknown_act(name), stock),
            Question("refuse: unknown place", noun.unknown_place(), stock),
            Question("refuse: beside a place", verb.beside_place(), stock),
            Question("refuse: other talk", verb.chat(), stock),
            Question("refuse: nothing named", known.pointing(), stock),
            Question("refuse: two things", known.two(name, other), stock),
            Question("refuse: missing thing", absent, stock),
        ]


def examine(folds: Sequence[int], seeds: Sequence[int], each: int, phrases: int) -> dict[str, Any]:
    """Cross-validated figures: of each seed, and of all answers together."""
    encoder = shared_encoder()
    answers: list[Answer] = []
    by_seed = {}
    for seed in seeds:
        own: list[Answer] = []
        for number in folds:
            known, unheard = fold(number, seed)
            reader = fit_reader(known, ReaderFitSettings(phrases=phrases, seed=seed))
            own += ask(reader, Examiner(known, unheard, seed).questions(each), encoder)
            done = figures(own)["unheard words"]["success"]
            print(f"seed {seed}, fold {number}: unheard words so far {done:.3f}", flush=True)
        by_seed[str(seed)] = figures(own)["unheard words"]
        answers += own
    return {"folds": list(folds), "seeds": by_seed, **figures(answers)}


def final(reader: Reader, each: int) -> dict[str, Any]:
    """Figures of a reader on the words of the exam, which it never heard, and everyday phrases."""
    encoder = shared_encoder()
    heard = ask(reader, everyday_questions(), encoder)
    return {
        **figures(ask(reader, Examiner(*exam(), seed=0).questions(each), encoder)),
        "everyday": {
            kind: rates([one for one in heard if one.question.kind == kind])
            for kind in dict.fromkeys(one.question.kind for one in heard)
        },
    }


def everyday_questions() -> list[Question]:
    """What people say and what must be refused, by writing; each on one of the tables where it can
    be done, on both in turn."""
    asked = []
    for writing in writings():
        for command, phrases in writing.said.items():
            skill = parse(command)
            for number, text in enumerate(phrases):
                needs = {skill.object or skill.verb, writing.held.get(text, "")} & set(BODY_NAMES)
                stocks = [stock for stock in STOCKS if needs.issubset(stock)]
                said = Said(text, (), "", command)
                asked.append(Question(writing.name, said, stocks[number % len(stocks)]))
        asked += [
            Question(
                f"{writing.name}, impossible", Said(text, (), "", ""), (KITCHEN, TABLE)[at % 2]
            )
            for at, text in enumerate(writing.refused)
        ]
    return asked


def main() -> None:
    """Examine, print the table, write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--report", type=Path, required=True, help="JSON file of the figures")
    parser.add_argument("--folds", type=int, nargs="+", default=list(range(FOLDS)))
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="of the split")
    parser.add_argument("--each", type=int, default=2, help="questions of a kind about each thing")
    parser.add_argument("--phrases", type=int, default=24_000, help="to learn from")
    args = parser.parse_args()
    found = examine(args.folds, args.seeds, args.each, args.phrases)
    args.report.write_text(json.dumps(found, indent=1) + "\n")
    print(table(found))


if __name__ == "__main__":
    main()
