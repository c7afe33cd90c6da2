"""Model cards of what is trained here: the recipe in sentences, and what was measured."""

from collections.abc import Sequence
from datetime import UTC, datetime

from services.learner.pretrain.scale import SCALES, Scale
from shared.policies.checkpoint import Card, Figure
from shared.policies.high_level import BASE_VERSION, HighLevel
from shared.workcell.skills import COMMANDS

THEN = " && "
"""Between the commands that a card names."""
RETEACH = "python -m services.learner.pretrain.reteach --low-level DIR/low_level"


def today() -> str:
    """When a card is written."""
    return datetime.now(UTC).date().isoformat()


def _command(scale: Scale, seed: int) -> str:
    name = next((name for name, known in SCALES.items() if known == scale), "custom")
    return f"hld pretrain --out DIR --scale {name} --seed {seed}"


def low_level(scale: Scale, seed: int, data_sha256: str) -> Card:
    """Of the low level, before it was examined."""
    practice = sum(round_.practice for round_ in scale.low)
    updates = sum(round_.updates for round_ in scale.low)
    return Card(
        name="low-level",
        title="Low level of the simulated ALOHA cell",
        version="1",
        date=today(),
        recipe=(
            "The scripted expert worked in the lab, on both tables, in random chains of skills and "
            "in tasks; at times things were missing or the plate stood elsewhere; arms were "
            "shaky, hands slipped (0.3 % of steps), and 5 % of commands were wrong.",
            f"In later rounds the network drove for up to 50 steps and the expert took over "
            f"(DAgger); in all {len(scale.low)} rounds and {practice:,} steps of the expert.",
            f"The network regressed chunks of 10 steps, {updates:,} updates of 1,024 rows (a "
            "moment and an arm), AdamW with a cosine, averaged weights. It is told the verb and "
            "points at the thing; a second output tells whether the command is achieved.",
            f"Its reader was taught {scale.phrases:,} phrases drawn from a lexicon: which part "
            "each word plays, what is asked for, which thing and place are named, and what nobody "
            "here can do; a tenth of the words was kept to measure.",
        ),
        command=_command(scale, seed),
        seed=seed,
        data_sha256=data_sha256,
        tensors_sha256="",
        limits=(
            "It is told where the objects are (tokens from the simulator), it does not see.",
            "It knows twenty commands and reads other words for them, in English; some it refuses "
            "and some, mostly rare names of things, it takes for another thing.",
            "One arm moves at a time, and it does not plan around the other.",
        ),
    )


def high_level(scale: Scale, seed: int, data_sha256: str, policy: HighLevel) -> Card:
    """Of the base of the high level, before it was examined."""
    updates = sum(round_.updates for round_ in scale.high)
    driven = sum(round_.driven for round_ in scale.high)
    return Card(
        name="high-level",
        title="High level of the simulated ALOHA cell, base",
        version=str(BASE_VERSION),
        date=today(),
        recipe=(
            *_demonstrated(scale),
            "A network that sees eighteen slots, reads the prompt word by word, feels its arms and "
            f"looks back three times was trained from scratch, {updates:,} updates of "
            f"{scale.high_batch} decisions; its bank head puts the meaning of the right command "
            "nearest among the twenty, its text head says it word by word. 50 % of histories and "
            "20 % of earlier looks were hidden, single ones of the others too.",
            "Two more losses shaped it, on where each body is and on what their prompts and "
            f"{scale.prompts:,} more prompts mean for each thing; their weights are not kept.",
            f"In {driven:,} more episodes, between its {len(scale.high)} rounds, it said itself "
            "what was done in most decisions, and learned what the task's oracle would have said.",
        ),
        command=_command(scale, seed),
        seed=seed,
        data_sha256=data_sha256,
        tensors_sha256="",
        limits=(
            "Trained in the lab alone: at another site it is far worse, until it is corrected.",
            "Prompts that read unlike the tasks' own were never seen.",
            "What lay on which side at the start it can only tell from what it sees now.",
        ),
        settings={**policy.settings(), "bank": "\n".join(COMMANDS)},
    )


def demonstrations(scale: Scale, seed: int, data_sha256: str) -> Card:
    """Of the decisions that are kept for replay."""
    return Card(
        name="demonstrations",
        title="Demonstrations from the lab, kept for replay",
        version=str(BASE_VERSION),
        date=today(),
        recipe=(
            *_demonstrated(scale),
            f"Whole episodes with at most {scale.replay:,} decisions were drawn, those with rare "
            "commands more often, and their pictures packed as sheets of JPEG.",
        ),
        command=_command(scale, seed),
        seed=seed,
        data_sha256=data_sha256,
        tensors_sha256="",
    )


def _demonstrated(scale: Scale) -> tuple[str, ...]:
    return (
        f"{scale.expert_episodes:,} episodes of all tasks in the lab by the expert's hand and "
        f"{scale.learned_episodes:,} by the low level's, 40 % of unusual length, 40 % of "
        "prompts with constraints, in all manners; a decision every 20 steps, each labelled "
        f"with the oracle's command; {scale.expert_mistakes:.0%} and {scale.learned_mistakes:.0%} "
        "of decisions began a wrong stretch, hands slipped in 0.2 % of steps, the expert's arms "
        "shook.",
    )


def retaught(card: Card, phrases: int, seed: int, figures: Sequence[Figure]) -> Card:
    """The card of a low level whose reader alone was taught anew. phrases: 0: it was not, and only
    examined. seed: of what was drawn. figures: of its reading; those of paraphrases in the cell
    were another reader's."""
    kept = [one for one in card.figures if one.name.startswith(("skill", "oracle"))]
    kept = [one for one in kept if "unheard" not in one.name]
    lesson = (
        f"Later its reader was taught a larger lexicon, and its motions left as they were: its "
        f"tagger went on learning from {phrases:,} phrases drawn from it, and what tells acts, "
        "things and places was fitted anew (`python -m services.learner.pretrain.reteach`)."
    )
    before = tuple(step for step in card.recipe if not step.startswith("Later its reader"))
    made = card.command.partition(THEN)[0]
    again = f"{made}{THEN}{RETEACH} --out DIR/retaught --phrases {phrases} --seed {seed}"
    update: dict[str, object] = {"recipe": (*before, lesson), "command": again} if phrases else {}
    return card.model_copy(update={**update, "date": today(), "figures": (*kept, *figures)})


def examined(card: Card, figures: Sequence[Figure]) -> Card:
    """The card with what was measured."""
    return card.model_copy(update={"figures": tuple(figures)})
