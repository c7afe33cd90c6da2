"""Phrases that are drawn: each word has its part, and what is kept is never taught."""

import numpy as np

from services.learner.pretrain.lexicon import exam
from services.learner.pretrain.reader_fit import drawn
from services.learner.pretrain.unheard import unheard_phrases, unheard_refusals
from services.learner.pretrain.words import Speaker
from shared.policies.reader.phrase import CONTRAST, FILLER, PLACE, THING, take_apart, words_of
from shared.workcell.skills import COMMANDS, PUT_IN_BIN

KNOWN = exam()[0]


def speaker(seed: int = 0) -> tuple[Speaker, np.random.Generator]:
    rng = np.random.default_rng(seed)
    return Speaker(KNOWN, KNOWN, KNOWN, rng), rng


def test_every_word_of_a_phrase_plays_one_part_and_equal_seeds_draw_alike() -> None:
    drawer, rng = speaker()
    said = drawn(drawer, 600, rng)
    assert all(len(words_of(one.text)) == len(one.parts) for one in said)
    assert {part for one in said for part in one.parts} == set(range(5))
    assert {one.meant for one in said} == {"", *COMMANDS}
    first, again = speaker(5), speaker(5)
    assert drawn(first[0], 20, first[1]) == drawn(again[0], 20, again[1])


def test_a_put_that_names_what_is_held_has_a_thing_and_a_place() -> None:
    said = speaker()[0].put("bin", "can")
    assert said.meant == PUT_IN_BIN
    apart = take_apart(words_of(said.text), said.parts)
    assert len(apart.things) == len(apart.places) == 1
    assert {THING, PLACE} <= set(said.parts)


def test_the_thing_that_is_not_meant_is_told_apart() -> None:
    drawer, _ = speaker()
    for _ in range(30):
        said = drawer.contrasted("cup", "bowl")
        assert CONTRAST in said.parts
        assert len(take_apart(words_of(said.text), said.parts).things) == 1
        assert said.meant == "pick up the cup"


def test_what_lies_beside_a_place_is_none_and_named_things_stay_where_they_are() -> None:
    drawer, _ = speaker()
    removals = {text.split()[0] for group in KNOWN.others["removals"] for text in group}
    for named in ("", "cup") * 30:
        said = drawer.beside_place(named)
        place = take_apart(words_of(said.text), said.parts).places[0]
        assert (said.act, said.meant) == ("put", "")
        assert not named or place.split()[0] not in removals


def test_a_thing_may_be_named_in_a_remark_before_it_is_asked_for() -> None:
    drawer, _ = speaker(3)
    said = [drawer.pick("cup", framed=True) for _ in range(300)]
    remarked = [one for one in said if one.parts[0] == FILLER and THING in one.parts]
    assert remarked
    for one in remarked:
        assert len(words_of(one.text)) == len(one.parts)
        assert len(take_apart(words_of(one.text), one.parts).things) == 1


def test_a_put_in_the_bin_may_name_what_is_held_and_no_place() -> None:
    drawer, _ = speaker()
    said = [drawer.put("bin", "can") for _ in range(60)]
    direct = [one for one in said if one.act == "bin"]
    assert direct
    assert all(THING in one.parts and PLACE not in one.parts for one in direct)


def test_courtesy_is_only_added() -> None:
    drawer, _ = speaker()
    plain = drawer.wait()
    dressed = drawer.dressed(plain)
    assert plain.text in dressed.text
    assert FILLER in dressed.parts
    assert dressed.meant == plain.meant


def test_a_slip_keeps_the_number_of_words() -> None:
    drawer, _ = speaker()
    for _ in range(50):
        said = drawer.pick("lettuce")
        slipped = drawer.misspelt(said)
        assert len(words_of(slipped.text)) == len(said.parts)


def test_phrases_of_the_exam_are_new_and_as_many_for_every_command() -> None:
    told = unheard_phrases()
    assert [len({one.phrase for one in row}) for row in told] == [len(row) for row in told]
    assert min(map(len, told)) >= 10
    assert {one.new for one in told[0]} == {"verb", "noun", "both"}
    assert told == unheard_phrases()
    drawer, rng = speaker()
    taught = {one.text for one in drawn(drawer, 2_000, rng)}
    assert not taught & {one.phrase for row in told for one in row}
    assert len(unheard_refusals()) >= 50
