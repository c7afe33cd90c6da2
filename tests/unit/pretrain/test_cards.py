"""What a card says of how a checkpoint was made."""

from services.learner.pretrain import cards
from services.learner.pretrain.scale import SCALES
from shared.policies import checkpoint
from shared.policies.checkpoint import Card, Figure, describe

READ = Figure(name="everyday phrases a", value=0.5, n=2, interval=(0.1, 0.9))
DRIVEN = Figure(name="skill pick, lab", value=1.0, n=2, interval=(0.3, 1.0))


def made() -> Card:
    card = cards.low_level(SCALES["full"], 0, "0" * 64)
    return card.model_copy(update={"figures": (DRIVEN, READ)})


def test_a_card_names_both_commands_once_its_reader_was_taught_anew() -> None:
    first = "hld pretrain --out DIR --scale full --seed 0"
    assert made().command == first
    once = cards.retaught(made(), 4_000, 3, (READ,))
    pretrain, reteach = once.command.split(" && ")
    assert pretrain == first
    assert reteach == (
        "python -m services.learner.pretrain.reteach --low-level DIR/low_level "
        "--out DIR/retaught --phrases 4000 --seed 3"
    )
    assert once.figures == (DRIVEN, READ)


def test_teaching_again_replaces_the_lesson_before_and_an_examination_is_none() -> None:
    once = cards.retaught(made(), 4_000, 0, ())
    again = cards.retaught(once, 5_000, 0, ())
    assert len(again.recipe) == len(once.recipe) == len(made().recipe) + 1
    assert again.command.count("reteach") == 1
    examined = cards.retaught(again, 0, 0, (READ,))
    assert (examined.command, examined.recipe) == (again.command, again.recipe)
    assert READ in examined.figures


def test_the_low_level_that_comes_with_the_project_names_all_that_made_it() -> None:
    folder = checkpoint.bundled("low_level")
    tensors, card = checkpoint.load(folder)
    assert card.command == cards.retaught(made(), 4_000, 0, ()).command
    assert (folder / checkpoint.README_FILE).read_text() == describe(card, tensors)
