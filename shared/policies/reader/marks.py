"""Words by which a clause denies, dislikes or tells of what was, see `asking.py`."""

import re

from shared.policies.reader.phrase import words_of


def _any(*words: str) -> re.Pattern[str]:
    return re.compile(rf"(?<![\w'])(?:{'|'.join(words)})(?![\w'])")


DENIES = _any(
    "not", "never", "no one", "nobody", "nothing", "nowt", "none", "neither", "nor", "cannot",
    r"\w+n't", "(?:do|does|did|wo|is|are|was|ca|should|must|would)nt", "without",
    "under no circumstances", "(?:at|in) no (?:time|way)",
)  # fmt: skip

ENDS = _any(
    "avoid", "refrain", "desist", "ignore", "abort", "cancel", "cease", "forbidden", "prohibited",
    "banned", "enough", "already", "(?:skip|forget)(?! to )", "never mind", "give over", "hold off",
    "hands off", "off limits", "(?:stay|keep|steer) (?:well )?(?:away|clear|off)",
    r"keep \w+ (?:\w+ )?off", r"(?:quit|stop) (?:\w+ing|it with)", "wants? leaving",
    r"leave (?!it |that |this )(?:\w+ )+(?:alone|be|where|as|off|out)",
    r"(?<!you )(?<!n't )(?<!not )(?<!never )(?<!to )(?:mind|beware(?: of)?) (?:the|that|my|your)",
    r"(?:look|watch) (?:at|out for) (?:the|that|my)", "(?:be )?careful (?:of|with) (?:the|that|my)",
    "(?:stays?|remains?) (?:put|there|where|in place|on the table)",
)  # fmt: skip
"""What is to be ended or let alone."""
_DISLIKES = (
    "hates?", "loathes?", "detests?", "despises?", "dislikes?", r"disgust\w+", "gross", "horrid",
    "horrible", "allergic", "vegan", "(?:sick|tired|my fill) of", "fed up", "makes? me", "refuses?",
    "fails? to", "shame", "pity", "object to", "withdraw",
)  # fmt: skip
_REMARKS = (
    "why(?! don't| not)", "how come", "who (?:on earth|told|said|asked|put|gave|has|is|was|did)",
    "who's", "whoever", "(?:thank you|thanks|cheers|ta) for", r"what an? (?:\w+ )*\w+ (?:of|that)",
    "(?:nice|good|great|lovely|beautiful|well) (?:catch|pick|throw|job|done|picked|caught)",
    "mistake", "wrong", "too (?:early|late|soon|far|hot)",
)  # fmt: skip
"""Questions about what was done, thanks, praise, blame."""
_WAS = (
    "was", "were", "did", "had", "been", "should(?:n't)? have", "went", "fell", "fallen", "broke",
    "broken", "ended up", "ran out", "gone (?:and|off|mouldy)", "ate", "eaten", "slipped",
    r"got \w+ed", "failed", "collided", "leaked", "landed", "missed", "spilled", "spilt", "knocked",
    "(?:i|we|you|he|she|they) used to",
)  # fmt: skip
TELLING = _any(*_DISLIKES, *_REMARKS, *_WAS)

_HOW = "(?:(?:very|so|too|quite|rather|really|all|still|already|now|just|almost|nearly|a bit) )*"
_SUBJECT = (
    r"(?:(?:the|my|your|this|that|our) )?"
    r"(?!(?:next|what|all|where|time|there|now|how|who|which|here)\b)\w+"
    r"(?: (?!(?:that|which|i|we|you|next|up)\b)\w+)?"
)
_ASKED = (
    r"(?:the|a|an|my|your|our|his|her|next|for|to|what|where|time|needed|wanted|required|due|"
    r"supposed|going|after|one|who|that|it|it's|i|up|coming|waiting|allowed|meant|ready for|"
    r"rubbish|"
    r"trash|garbage|waste|junk|litter)\b"
)
"""After "is" they tell what is wished: "the ham is next", "it is for the bin"."""
STATES = re.compile(
    r"there(?: is|'s| are)(?: still| only)? (?:a|an|some|no) |"
    rf"(?:(?:it|this|that|they|he|she)(?: is|'s| are|'re)|{_SUBJECT} (?:is|are)) {_HOW}(?!{_ASKED})"
)
"""A clause that begins so says how things are: "the bin is full", "it is in the tub"."""
DOES = _any(
    "(?:you|he|she|it|they|we|i|somebody|someone|robot|arm|who)(?: have|'ve| has|'s| are| is|'re|"
    r" \w+ly| always| keeps?| just| only| already| almost)*(?= \w)"
)
"""Somebody, up to what they do or did."""
UNCHANGED = frozenset(("put", "set", "let"))
"""Of the past too, where somebody does so to something: "you put it there"."""
ACTED = frozenset(words_of("took taken threw thrown chose brought caught left gave laid got"))
"""What they did, where the verb has no -ed."""

NO_USE = frozenset(words_of("need more further use call reason grounds point wish sense"))
"""After "no" they are denied by it."""
ORDERS = _any(
    "(?:i|we)(?:'d| would)? (?:just |only |clearly )?(?:said|meant|wanted|asked for|was talking|"
    "was thinking|was after)",
    "what (?:i|we) (?:meant|wanted|asked for) (?:was|is)",
    "(?:was|is) what (?:i|we) (?:said|meant|wanted|asked for)",
    "i was (?:just )?(?:wondering|hoping)", "you (?:could|would)n't (?:just|happen)",
    "(?:was|were) (?:supposed|meant) (?:to|for)", "(?:ca|could|wo|would)n't you",
    "why (?:don't|not)(?: you| we)?",
    "(?:don't|do not|stop|quit) (?:keep|hold)(?:ing)?(?: holding)?(?: on| onto)? (?:it|that|this)",
    "(?:don't|not) (?:forget|fail|hesitate|worry)", "(?:don't|not) mind",
    "not (?:there|that|this|so|too|yet|now|only|sure)",
)  # fmt: skip
"""No marks: what one said is an order, and so is what one invites to."""

_IT = r"(?:it|that|this|on|the \w+)"
_NOT = "(?:don't|do not|dont|never)"
KEEPS = _any(
    r"(?<!not )(?<!n't )(?<!stop )(?<!dont )"
    rf"(?:keep|carry on|go on)(?: on)? (?:holding|gripping|carrying)(?: on to| onto)?(?: {_IT})?",
    rf"keep(?: a)?(?: tight| firm| good)? (?:hold|grip) (?:of|on) {_IT}",
    r"(?:hold|hang) (?:on to|onto) (?:it|that|this)",
    rf"(?:keep|leave|hold) {_IT} in (?:your|the) (?:\w+ )?(?:hands?|gripper|fingers|claws?)",
    rf"{_NOT} (?:let (?:{_IT} )?go|release|lose|loosen)(?: of)?(?: (?:{_IT}|your grip))?",
)
"""What is held is to stay in the hand."""
LETS_GO = _any(rf"{_NOT} (?:drop {_IT}|put {_IT} down|put down {_IT})")
"""Said beside it this is no prohibition more."""

VERBAL = frozenset(
    words_of(
        "is are was were be am has have had do does did can could would will shall should must "
        "may might i'm it's that's he's she's they're we're you're"
    )
)
"""Before "not" they belong to it."""
RELATIVE = frozenset(
    words_of("that which who whose i you we he she nobody nobody's that's without")
)
"""Right after a thing they tell more of it."""
LEADING = frozenset(
    words_of(
        "to you i we they he she it and or nor would must may might should shall could can will "
        "not never don't have has been for of"
    )
)
"""A verb right after them is no order by itself."""
ADVERB = re.compile(r"just|only|already|literally|\w+ly")
ASKING = frozenset(words_of("can could would will should if want need let"))
"""Before "you" they make an order of what follows."""
NAMING = frozenset(("what", "where"))
"""Before "you" they make a name of it: "what you've got there"."""
AWAY = frozenset(words_of("back away off out over down up"))
"""At the beginning of a clause they are an order without a verb."""
