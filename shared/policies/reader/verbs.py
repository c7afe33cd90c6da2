"""The verbs that clauses are judged by, in all their forms."""

from collections.abc import Iterable, Sequence

PICK, PUT, WAIT, HOLD, MOVE = ("pick", "put", "wait", "hold", "move")
"""To take; to let go of; to do nothing; what is done with what is held; to act in any other way."""

_VERBS = {
    PICK: "pick take grab get fetch lift collect retrieve seize raise bring hand snaffle nab nick "
    "pinch filch swipe pilfer purloin pocket collar cop clutch clasp grasp grapple grip glom latch "
    "corral tweeze lasso heft cradle hoist hoick hoik pluck procure commandeer confiscate nobble "
    "snag yoink cuff snare prise pry winkle harvest recover requisition scoop gather capture "
    "extract withdraw acquire obtain select choose remove secure snatch catch elevate uplift",
    PUT: "put place set lay drop throw toss chuck fling bin dump trash discard release stack "
    "stick deposit return leave plonk plop plunk bung sling lob hurl pitch jettison ditch scrap "
    "junk yeet huck hoy eject perch nestle drape plant unload offload stash stow tuck cram stuff "
    "shove transfer relocate consign unhand relinquish plate tub",
    WAIT: "wait pause stop halt freeze",
    HOLD: "hold keep touch stay stand remain bide linger",
    MOVE: "move do go carry start",
}
_PAST = {"taken": PICK, "thrown": PUT, "laid": PUT}
_HANDS = frozenset(("hand", "hands", "arm", "arms", "gripper"))
_OWN = frozenset(("your", "the", "a", "both"))


def _forms(verb: str) -> Iterable[str]:
    """A verb as it is, with -s, -ing and -ed."""
    stem = verb.removesuffix("e")
    twice = verb + verb[-1]
    yield from (verb, f"{verb}s", f"{stem}ing", f"{stem}ed", f"{twice}ing", f"{twice}ed")


_KINDS = {
    form: kind for kind, verbs in _VERBS.items() for verb in verbs.split() for form in _forms(verb)
} | _PAST


def verb_of(words: Sequence[str], row: int) -> str:
    """The kind of verb that stands there, "" for none."""
    word, after = words[row], list(words[row + 1 : row + 3])
    if word == "let":
        return PUT if "go" in words[row + 1 : row + 4] else ""
    if word in ("get", "getting") and after[:1] == ["rid"]:
        return PUT
    if word in ("go", "goes", "going") and "let" in words[max(row - 3, 0) : row]:
        return ""  # It belongs to "let".
    if word.startswith("hand") and after[:1] not in (["me"], ["us"], ["over"]):
        return ""
    kind = _KINDS.get(word, "")
    if kind == PUT and after[:1] and after[0] in _OWN and after[1:] and after[1] in _HANDS:
        return MOVE  # To put a hand somewhere lets go of nothing.
    return kind
