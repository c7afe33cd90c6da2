"""What words of a clause tell by themselves: sides of places, what is taken off them, several."""

import re

SIDES = re.compile(
    r"\b(?:(?:the|your|my|its|far|to|on) (?:far )?(?:left|right)|left of|(?:left|right)-hand)\b"
    r"(?![- ](?:hands? |hands?$|arm|gripper|place|spot|way|thing))"
)
ALONE = re.compile(
    r"\b(?:leave|let) (?!it\b|that (?:alone|be)\b|this\b|them\b|me\b).* (?:alone|be)\b"
)
OFF = re.compile(
    r"\b(?:from|off|out of) (?:(?:the|my|that|this|your) )?"
    r"(?:\w+ )?(?:plate|dish|sandwich|stack|bin|tub|box|trash|garbage|rubbish)\b"
    r"(?!.* (?:to|in|into|on|onto) )"
)
BESIDE = re.compile(
    r"(?:down |over |right |somewhere |anywhere )*(?:beside|besides|next to|near|nearby|close to|"
    r"by|alongside|along|adjacent to|around|round|against|between|behind|under|underneath|beneath|"
    r"below|above|outside|opposite|past|in front of|across from|far from|away from|"
    r"(?:to )?(?:the )?(?:left|right) of|(?:on|at|to) the (?:edge|rim|side) of) "
    r"(?!(?:itself|hand|me|us|you)\b)"
)
"""How a place begins that is no place of its own: "next to the plate"."""
MANY = re.compile(
    r"\b(?:(?:all|both)(?: of)? (?:the|these|those|my|your|them)(?! (?:way|time|same))|"
    r"(?:put|pack|place) everything|"
    r"(?:every|each)(?: of)? (?!time|way|now|it)\w+)\b"
)
