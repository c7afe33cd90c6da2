"""What has an end that must not be forgotten can be used in a `with` block."""

from types import TracebackType
from typing import Protocol, Self


class Closing(Protocol):
    """Inherit it and write `close`."""

    def close(self) -> None:
        """Give everything back; closing twice is fine."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
