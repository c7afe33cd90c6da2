"""Bytes become messages or a `MessageError` that says why; nothing else ever happens."""

import json
import tracemalloc

import numpy as np
import pytest
import safetensors.numpy
from hypothesis import given
from hypothesis import strategies as st

from shared.errors import MessageError
from shared.messages.correction import Correction
from shared.messages.decision import Decision
from shared.messages.frame import Frame
from shared.messages.policy import PolicyAnnouncement
from shared.messages.receipt import Receipt
from shared.wire.codec import MAX_BYTES, MAX_HEADER_BYTES, decode, encode
from tests.contract.samples import arrays, samples

SAMPLES = samples()
DECISION = encode(SAMPLES[Decision])


def packed(header: object, body: bytes = b"") -> bytes:
    """A safetensors payload with any header, right or wrong."""
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return len(text).to_bytes(8, "little") + text + body


def head_of(data: bytes) -> tuple[dict, bytes]:
    """The header of a safetensors payload, and what comes after it."""
    size = int.from_bytes(data[:8], "little")
    return json.loads(data[8 : 8 + size]), data[8 + size :]


def with_head(**fields: object) -> bytes:
    """The sample decision with other fields in its JSON head."""
    header, body = head_of(DECISION)
    head = json.loads(header["__metadata__"]["head"]) | fields
    header["__metadata__"]["head"] = json.dumps(head)
    return packed(header, body)


def with_tensor(name: str, **fields: object) -> bytes:
    """The sample decision with another description of one array."""
    header, body = head_of(DECISION)
    header[name] = header.get(name, {}) | fields
    return packed(header, body)


@pytest.mark.parametrize("cls", SAMPLES, ids=lambda cls: cls.__name__)
def test_a_message_comes_back_as_it_was(cls):
    message = decode(cls, encode(SAMPLES[cls]))
    assert message.without_arrays() == SAMPLES[cls].without_arrays()
    assert message.arrays.keys() == SAMPLES[cls].arrays.keys()
    for name, array in message.arrays.items():
        np.testing.assert_array_equal(array, SAMPLES[cls].arrays[name])


@pytest.mark.parametrize("cls", SAMPLES, ids=lambda cls: cls.__name__)
def test_the_same_message_has_the_same_bytes(cls):
    assert (
        encode(SAMPLES[cls]) == encode(samples()[cls]) == encode(decode(cls, encode(SAMPLES[cls])))
    )


def test_an_array_in_another_memory_order_travels_as_what_it_says():
    turned = arrays() | {"objects": np.arange(81, dtype=np.float32).reshape(9, 9).T}
    sliced = turned | {"images": np.zeros((2, 128, 128, 3), np.uint8)[:, ::2, ::2]}
    message = SAMPLES[Decision].model_copy(update={"arrays": sliced})
    back = decode(Decision, encode(message))
    np.testing.assert_array_equal(back.arrays["objects"], turned["objects"])


def test_arrays_that_arrived_cannot_be_written_to():
    message = decode(Decision, DECISION)
    for array in message.arrays.values():
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_a_payload_is_a_safetensors_file_for_anybody():
    tensors = safetensors.numpy.load(DECISION)
    assert {name: array.shape for name, array in tensors.items()} == {
        "images": (2, 64, 64, 3),
        "objects": (9, 9),
        "proprioception": (22,),
    }


@given(st.binary(max_size=200))
def test_any_bytes_are_a_message_or_refused(data):
    for cls in (Receipt, Decision):
        with pytest.raises(MessageError, match=cls.__name__):
            decode(cls, data)


@given(st.integers(0, len(DECISION) - 1))
def test_a_payload_cut_short_is_refused(length):
    with pytest.raises(MessageError):
        decode(Decision, DECISION[:length])


@given(st.integers(0, 2000), st.integers(0, 255))
def test_a_payload_with_a_wrong_byte_is_another_message_or_refused(place, byte):
    data = bytearray(DECISION)
    data[place] = byte
    try:
        assert isinstance(decode(Decision, bytes(data)), Decision)
    except MessageError:
        return


@given(st.recursive(st.none() | st.booleans() | st.floats() | st.text(max_size=5),
                    lambda inner: st.lists(inner, max_size=3)
                    | st.dictionaries(st.text(max_size=5), inner, max_size=3)))  # fmt: skip
def test_any_json_is_a_message_or_refused(tree):
    for cls in (Correction, PolicyAnnouncement):
        with pytest.raises(MessageError):
            decode(cls, json.dumps(tree).encode())
    with pytest.raises(MessageError):
        decode(Decision, packed(tree))


@pytest.mark.parametrize("cls", [Receipt, Decision])
def test_a_payload_that_is_too_large_is_refused_before_it_is_copied(cls):
    data = encode(SAMPLES[cls]) + bytes(MAX_BYTES)
    tracemalloc.start()
    try:
        with pytest.raises(
            MessageError, match=f"{len(data)} bytes is too large: at most {MAX_BYTES}"
        ):
            decode(cls, data)
        assert tracemalloc.get_traced_memory()[1] < 100_000
    finally:
        tracemalloc.stop()


def test_a_message_too_large_to_travel_is_refused_where_it_is_made():
    with pytest.raises(MessageError, match="too large: at most 100"):
        encode(SAMPLES[Decision], max_bytes=100)
    with pytest.raises(MessageError, match="too large: at most 100"):
        decode(Decision, DECISION, max_bytes=100)


@pytest.mark.parametrize("size", [2**63 - 1, 2**64 - 1, MAX_HEADER_BYTES + 1, 1000])
def test_a_header_that_claims_more_than_there_is_costs_nothing(size):
    tracemalloc.start()
    try:
        with pytest.raises(MessageError, match=f"header {size}"):
            decode(Decision, size.to_bytes(8, "little") + b"{}" * 10)
        assert tracemalloc.get_traced_memory()[1] < 100_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "fields",
    [
        {"shape": [2**31, 2**31]},
        {"shape": [2**62, 4]},
        {"shape": [10**30]},
        {"shape": [-1, 22]},
        {"shape": [[22]]},
        {"shape": 22},
        {"data_offsets": [0, 2**40]},
        {"data_offsets": [412, 324]},
        {"data_offsets": [0, 88]},
        {"data_offsets": [-88, 0]},
        {"data_offsets": []},
        {"dtype": "BF16"},
        {"dtype": "F64"},
        {"dtype": "object"},
        {"dtype": None},
        {"extra": 1, "dtype": "I32"},
    ],
)
def test_a_description_of_an_array_that_lies_is_refused(fields):
    with pytest.raises(MessageError, match="Decision"):
        decode(Decision, with_tensor("proprioception", **fields))


def test_bytes_that_no_array_claims_are_refused():
    with pytest.raises(MessageError):
        decode(Decision, DECISION + b"trailer")


def test_an_array_that_the_message_does_not_declare_is_refused():
    with pytest.raises(MessageError, match=r"carries arrays .*surprise"):
        decode(
            Decision, with_tensor("surprise", dtype="U8", shape=[0], data_offsets=[24988, 24988])
        )


def test_an_array_beyond_what_the_message_allows_is_refused():
    head = json.dumps(SAMPLES[Frame].without_arrays())
    data = safetensors.numpy.save({"jpeg": np.zeros((1 << 20) + 1, np.uint8)}, {"head": head})
    with pytest.raises(MessageError, match="jpeg"):
        decode(Frame, data)


@pytest.mark.parametrize(
    "metadata", [None, [], "head", {}, {"head": 1}, {"head": None}, {"h": "{}"}]
)
def test_arrays_without_a_head_are_no_message(metadata):
    header, body = head_of(DECISION)
    with pytest.raises(MessageError):
        decode(Decision, packed(header | {"__metadata__": metadata}, body))


def test_a_deeply_nested_head_is_refused():
    for text in (b"[" * 200_000, b'{"a":' * 100_000):
        with pytest.raises(MessageError, match="no JSON"):
            decode(Receipt, text)
        with pytest.raises(MessageError, match="no JSON"):
            decode(Decision, packed(text))
    with pytest.raises(MessageError):
        decode(Decision, with_head(truth="[" * 10_000))


@pytest.mark.parametrize("number", [b"NaN", b"Infinity", b"-Infinity"])
def test_a_number_that_is_none_is_refused(number):
    with pytest.raises(MessageError, match="no JSON"):
        decode(Receipt, b'{"step": ' + number + b"}")


def test_an_unknown_field_is_named_with_its_nearest():
    with pytest.raises(MessageError, match=r"Decision\.promt: .*nearest known: .*'prompt'"):
        decode(Decision, with_head(promt="a sandwich"))


def test_what_is_wrong_is_said_by_its_path():
    with pytest.raises(
        MessageError, match=r"Decision\.proposed\.0\.score: .*less than or equal to 1"
    ):
        decode(Decision, with_head(proposed=[{"goal": {"text": "wait"}, "score": 2}]))


@pytest.mark.parametrize("value", [{}, {"images": [[0]]}, None])
def test_arrays_never_travel_in_the_head(value):
    with pytest.raises(MessageError, match="never in it"):
        decode(Decision, with_head(arrays=value))
    data = json.dumps(SAMPLES[Receipt].without_arrays() | {"arrays": value}).encode()
    with pytest.raises(MessageError, match="never in it"):
        decode(Receipt, data)


def test_a_message_of_another_class_is_refused():
    with pytest.raises(MessageError):
        decode(Receipt, encode(SAMPLES[Correction]))
    with pytest.raises(MessageError):
        decode(Frame, DECISION)
