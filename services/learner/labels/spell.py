"""Spell: one spelling for each phrase, and one phrase for all that were said to mean the same.

A part of `aggregate.py`; a pure function of what people ruled.
"""

from collections.abc import Callable, Iterable

from shared.messages.ruling import Ruling, Verb

Spelling = Callable[[str], str]
"""From what was said to the phrase that a label has."""


def canonical(text: str) -> str:
    """The one spelling of a phrase: lower case, single spaces, no full stop at its end."""
    return " ".join(text.lower().split()).rstrip(".! ") or text


def spelling(rulings: Iterable[Ruling]) -> Spelling:
    """`canonical`, and then whatever somebody confirmed that it means.

    Aliases lead on to each other. Of several rulings about a phrase the last one counts, also one
    that says it means something else; one that would lead a phrase back to itself is left out.
    """
    leads: dict[str, str] = {}

    def follow(text: str, upto: str | None = None) -> str:
        """Where a phrase leads to; `upto`, as soon as it comes by it."""
        while text in leads and text != upto:
            text = leads[text]
        return text

    for ruling in sorted(rulings, key=lambda ruling: (ruling.created_ns, ruling.id)):
        if ruling.phrase is None or ruling.means is None:
            continue
        phrase, means = canonical(ruling.phrase), canonical(ruling.means)
        if ruling.verb is Verb.ALIAS and follow(means, upto=phrase) != phrase:
            leads[phrase] = means
        elif ruling.verb is Verb.DISTINCT:
            for one, other in ((phrase, means), (means, phrase)):
                if leads.get(one) == other:
                    del leads[one]
    return lambda text: follow(canonical(text))
