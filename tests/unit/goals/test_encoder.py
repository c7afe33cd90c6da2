"""The sentence encoder and the phrase bank."""

from pathlib import Path

import numpy as np
import pytest

from shared.errors import PolicyError
from shared.goals.family import open_family
from shared.goals.language import weights
from shared.goals.language.bank import PhraseBank
from shared.goals.language.encoder import TOKEN_WIDTH, Encoder, shared_encoder
from shared.messages.goal import LanguageGoal


def test_vectors_have_length_one_and_equal_sentences_equal_vectors() -> None:
    vectors = shared_encoder().embed(["put it down", "Put  it DOWN ", "wait"])
    assert vectors.shape == (3, 384)
    assert vectors.dtype == np.float32
    assert np.allclose(np.linalg.norm(vectors, axis=1), 1.0, atol=1e-5)
    assert np.array_equal(vectors[0], vectors[1])


def test_a_vector_does_not_depend_on_its_company() -> None:
    alone = Encoder().embed(["grab the cheese"])[0]
    among = Encoder().embed(["a much longer sentence than the other one", "grab the cheese"])[1]
    assert np.array_equal(alone, among)


def test_paraphrases_lie_nearer_than_other_commands() -> None:
    said, meant, other = shared_encoder().embed(
        ["take the cheese, please", "pick up the cheese", "put it in the bin"]
    )
    assert said @ meant > 0.7 > said @ other + 0.2


def test_two_known_cosines_are_those_of_the_published_model() -> None:
    a, b, c = shared_encoder().embed(["pick up the bread", "pick up the toast", "wait"])
    assert a @ b == pytest.approx(0.70, abs=0.01)
    assert a @ c == pytest.approx(0.12, abs=0.01)


def test_no_sentences_give_no_vectors() -> None:
    assert Encoder().embed([]).shape == (0, 384)


def test_remembered_vectors_need_no_weights() -> None:
    encoder = Encoder()
    vector = np.eye(1, 384, dtype=np.float32)
    encoder.remember(["Say  it"], vector)
    assert np.array_equal(encoder.embed(["say it"]), vector)


def test_foreign_weights_are_refused_with_their_hash(tmp_path: Path) -> None:
    file = tmp_path / "model.safetensors"
    file.write_bytes(b"something else")
    with pytest.raises(PolicyError, match=r"not the pinned.*reinstall"):
        weights.check(file, weights.WEIGHTS_SHA256)


def test_a_missing_file_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match=r"cannot read tokenizer.json"):
        weights.check(tmp_path / "tokenizer.json", weights.TOKENIZER_SHA256)


def test_the_language_family_embeds_and_describes_goals() -> None:
    family = open_family("language")
    goal = LanguageGoal(text="wait")
    assert family.embed((goal,)).shape == (1, family.width)
    assert family.describe(goal) == "wait"


def test_an_unknown_family_is_refused_with_the_known_ones() -> None:
    with pytest.raises(PolicyError, match=r"no goal family 'image'.*language"):
        open_family("image")


def test_the_bank_finds_what_was_meant() -> None:
    bank = PhraseBank.of(["pick up the cheese", "put it in the bin", "wait"])
    matches = bank.nearest("drop it into the bin", k=2)
    assert next(match.phrase for match in matches) == "put it in the bin"
    assert matches[0].score > matches[1].score


def test_the_bank_grows_at_its_end_and_only_once() -> None:
    bank = PhraseBank.of(["wait"])
    grown = bank.add("wave").add("wave")
    assert grown.phrases == ("wait", "wave")
    assert grown.index("wave") == 1
    assert bank.phrases == ("wait",)
    assert np.array_equal(grown.vectors[0], bank.vectors[0])


def test_an_unknown_phrase_is_refused_with_the_nearest() -> None:
    with pytest.raises(PolicyError, match=r"does not hold 'wayt'.*'wait'"):
        PhraseBank.of(["wait"]).index("wayt")


def test_a_bank_holds_each_phrase_once_and_at_least_one() -> None:
    with pytest.raises(PolicyError, match=r"only once"):
        PhraseBank.of(["wait", "wait"])
    with pytest.raises(PolicyError, match=r"at least one"):
        PhraseBank.of([])


def test_tokens_have_a_row_for_each_piece_and_differ_by_what_stands_beside_them() -> None:
    plain, denied = shared_encoder().tokens(["Tomato", "no  tomato"])
    assert plain.shape == (3, TOKEN_WIDTH)
    assert denied.shape == (4, TOKEN_WIDTH)
    assert not np.allclose(plain[1], denied[2], atol=0.05)
