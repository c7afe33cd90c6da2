"""Keys are made and taken apart, and nobody smuggles a wildcard in."""

import pytest
import zenoh
from hypothesis import given
from hypothesis import strategies as st

from shared.errors import MessageError
from shared.wire import keys

ids = st.from_regex(r"\A[a-z0-9-]{1,64}\Z")
chunks = st.sampled_from(["a", "b", "ab", "*", "**"])
patterns = (
    st.lists(chunks, min_size=1, max_size=6)
    .map("/".join)
    .filter(
        # Two ways to write one pattern; Zenoh wants the other.
        lambda text: "**/**" not in text and "**/*" not in text
    )
)
HOSTILE = [
    "",
    "*",
    "**",
    "a*",
    "$*",
    "a/b",
    "/",
    "..",
    "A",
    "ä",
    "a\n",
    "a b",
    "a?b",
    "a#b",
    "a" * 65,
]


def test_a_robot_key_reads_as_in_the_grammar():
    assert keys.robot_key("lab", "robot-1", "decision") == "hld/v1/lab/actor/robot-1/decision"
    assert keys.service_key("lab", "learner", "l", "policy") == "hld/v1/lab/learner/l/policy"
    assert keys.any_robot("lab", "decision") == "hld/v1/lab/actor/*/decision"
    assert keys.any_service("lab", "learner", "tensor") == "hld/v1/lab/learner/*/tensor"


@given(ids, ids, ids, ids)
def test_a_key_is_taken_apart_into_what_it_was_made_of(fleet, service, id, message):
    key = keys.service_key(fleet, service, id, message)
    assert keys.parse(key) == keys.Address(fleet, service, id, message)
    assert keys.intersects(keys.any_service(fleet, service, message), key)


@pytest.mark.parametrize("part", HOSTILE)
def test_no_part_of_a_key_can_be_a_wildcard_or_a_path(part):
    for place in range(4):
        parts = ["lab", "actor", "robot-1", "decision"]
        parts[place] = part
        with pytest.raises(MessageError, match="can't stand in a key"):
            keys.service_key(*parts)
        with pytest.raises(MessageError, match="is no key"):
            keys.parse("hld/v1/" + "/".join(parts))
    with pytest.raises(MessageError):
        keys.any_robot(part, "decision")
    with pytest.raises(MessageError):
        keys.any_robot("lab", part)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "hld",
        "hld/v1/",
        "hld/v1/a/b/c",
        "hld/v1/a/b/c/d/e",
        "hld/v2/a/b/c/d",
        "x/hld/v1/a/b/c/d",
    ],
)
def test_what_is_not_of_the_grammar_is_no_key(text):
    with pytest.raises(MessageError, match="<fleet>/<service>/<id>/<message>"):
        keys.parse(text)


def test_a_chunk_of_a_tensor_is_found_again_by_its_key():
    prefix = keys.service_key("lab", "learner", "l", "tensor")
    key = keys.chunk_key(prefix, "ab" * 32, 17)
    assert keys.parse_chunk(key) == ("ab" * 32, 17)
    assert keys.intersects(keys.chunk_key(prefix, "*", "*"), key)


@pytest.mark.parametrize(
    "key",
    ["", "a", "x/y", f"x/{'AB' * 32}/1", f"x/{'ab' * 31}/1"]
    + [f"x/{'ab' * 32}/{index}" for index in ("", "-1", "1234567", "١", "x")],
)
def test_what_is_no_chunk_is_said_so(key):
    with pytest.raises(MessageError, match="no key of a tensor chunk"):
        keys.parse_chunk(key)


@given(patterns, patterns)
def test_patterns_meet_as_zenoh_says_they_do(left, right):
    assert keys.intersects(left, right) == zenoh.KeyExpr(left).intersects(zenoh.KeyExpr(right))
