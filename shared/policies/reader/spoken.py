"""How people really talk and type, put as a book would: shorthand, dialect, drawn-out words."""

import re
import unicodedata

_SAID = {
    "you": "u ya ye thee thou",
    "your": "ur yer thy tha",
    "the": "da teh hte th",
    "that": "dat yon yonder",
    "this": "dis",
    "them": "em dem",
    "one": "un yin",
    "please": "pls plz pleez plse",
    "thanks": "thx tx",
    "with": "w wi",
    "of": "o",
    "and": "n an'",
    "before": "fore afore b4",
    "take": "tek tak",
    "make": "mek",
    "give": "gie",
    "get": "git",
    "put": "putt",
    "nothing": "nowt nuffin nothin",
    "anything": "owt anythin",
    "something": "summat sumthin somethin",
    "let me": "lemme",
    "going to": "gonna",
    "want to": "wanna",
    "have to": "gotta hafta",
    "could you": "cud couldja",
    "would you": "wouldja",
    "okay": "k kk okey",
    "thing": "thingy thingie thingummy thingamajig thingamabob thingymajig whatsit wotsit "
    "whatchamacallit doodah doohickey doodad gizmo",
    "little": "wee titchy tichy teeny teensy weeny teeny-weeny diddy dinky ickle itty-bitty "
    "itsy-bitsy lil li'l",
    "purple": "purply purplish purpley",
    "red": "reddish",
    "yellow": "yellowy yellowish",
    "green": "greeny greenish",
    "pink": "pinkish",
    "brown": "brownish",
    "white": "whitish",
    "grey": "greyish grayish",
    "blue": "bluish blueish",
    "sandwich": "sarnie sarny butty sanger sanga sammie sammy sammich sandwhich",
    "breakfast": "brekkie brekky",
    "chocolate": "choccy choccie choc",
    "biscuit": "biccy bikkie bickie",
    "hands": "mitts mits paws",
    "hand": "mitt",
    "moment": "mo tick jiffy",
    "moments": "ticks",
    "second": "sec",
    "seconds": "secs",
    "": "bloody blasted bleeding ruddy flippin damn damned darn darned goddamn wretched freakin "
    "freaking frigging friggin effing",
}
_WRITTEN = {word: plain for plain, words in _SAID.items() for word in words.split()}
_TOKEN = re.compile(r"[a-z0-9]+(?:['-][a-z0-9]+)*'?")
_CLIPPED = re.compile(r"\bt'(?=[a-z]{2})")
"""The article in the north of England: "t'table"."""
_INSIDE = re.compile(r"\b(?:inside|within)(?: of)?\b")
_COURTEOUS = re.compile(
    r"\b(?:(?:if|so long as|as long as) (?:you(?: don't| do not| wouldn't| would not) mind|"
    r"(?:it|that)(?:'s| is|'d be| would be)?(?: not|n't|n't be)? "
    r"(?:no |an? |any |too much |too big an? |too much of an? |such an? )"
    r"(?:bother|trouble|hassle|problem|imposition|inconvenience|fuss|effort|work|ask))|"
    r"unless (?:it|that)(?:'s| is) (?:an? |too much )(?:bother|trouble|hassle|problem))\b"
)
"""It negates nothing and is no condition: "if you don't mind", "if it isn't too much trouble"."""
_DRAWN_OUT = re.compile(r"([a-z])\1{2,}")


def unaccented(text: str) -> str:
    """The text without accents: "consommé" as it is typed without them."""
    apart = unicodedata.normalize("NFKD", text)
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def written(said: str) -> str:
    """A plain phrase with standard words for those that are only spoken or typed in haste."""
    said = _COURTEOUS.sub("please", said)
    said = _DRAWN_OUT.sub(r"\1\1", _CLIPPED.sub("the ", _INSIDE.sub("in", said)))
    return " ".join(_TOKEN.sub(_standard, said).split())


def _standard(found: re.Match[str]) -> str:
    token = found.group()
    word = token.strip("'")
    return _WRITTEN.get(word, token)
