"""What the oracle reads of the API."""

import pytest

from services.oracle.seen import UnclearError, parse


@pytest.mark.parametrize("content", [b"", b"{}", b"[]", b'{"id": 3}'])
def test_an_answer_that_is_no_decision_is_an_error(content: bytes) -> None:
    with pytest.raises(UnclearError):
        parse(content)
