"""How the words are split: nothing is on both sides."""

import pytest

from services.learner.pretrain.frames import frame_of
from services.learner.pretrain.lexicon import FOLDS, Lexicon, exam, fold
from shared.policies.reader.meant import PLACES
from shared.workcell.objects import OBJECT_NAMES


def texts(lexicon: Lexicon) -> set[tuple[int, str, str]]:
    return {
        (row, name, text)
        for row, table in enumerate(lexicon)
        for name, groups in table.items()
        for group in groups
        for text in group
    }


def test_every_thing_act_and_place_has_many_words() -> None:
    known, unheard = exam()
    assert tuple(known.things) == OBJECT_NAMES
    assert set(PLACES) < set(known.places)
    for name, groups in known.things.items():
        assert groups[0][0] == name
        assert len(groups) + len(unheard.things[name]) >= 45
    kept = {name: groups for table in unheard for name, groups in table.items()}
    unasked = {name for name, groups in kept.items() if not groups}
    assert unasked == {"places", "about", "named_plate", "named_bin", "named_tub"}


def test_what_is_kept_for_the_exam_is_in_no_fold() -> None:
    known, unheard = exam()
    assert not texts(known) & texts(unheard)
    for number in range(FOLDS):
        taught, tried = fold(number, seed=1)
        assert not texts(taught) & texts(tried)
        assert texts(taught) | texts(tried) == texts(known)


def test_folds_differ_with_the_seed_and_share_nothing_but_what_is_always_known() -> None:
    tried = [texts(fold(number, seed=1)[1]) for number in range(FOLDS)]
    assert sum(map(len, tried)) == len(set().union(*tried))
    assert texts(fold(0, seed=1)[1]) != texts(fold(0, seed=2)[1])
    assert all((0, "cup", "cup") in texts(fold(number, seed=1)[0]) for number in range(FOLDS))


def test_there_is_no_sixth_fold() -> None:
    with pytest.raises(ValueError, match="folds 0 to 4"):
        fold(FOLDS, seed=0)


def test_a_frame_of_the_lexicon_looks_as_the_reader_sees_it() -> None:
    assert frame_of("pick {} up") == "pick the object up"
    assert frame_of("{} goes []") == "the object goes to that place"
    assert frame_of("that's it, you're done") == "that's it you're done"
