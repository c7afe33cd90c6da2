"""Watch over the low level: it must not change by one bit while the high level learns."""

from pathlib import Path

from safetensors import SafetensorError
from safetensors.numpy import load_file

from shared.errors import FrozenError
from shared.policies.checkpoint import TENSORS_FILE, load, sha256_tensors


class FrozenLowLevel:
    """The low level as it was when the learner started; looked at before and after each round.

    sha256: over all tensors, which is what episodes and announcements call it by.
    """

    def __init__(self, folder: Path) -> None:
        """Read the checkpoint in `folder`.

        Raises:
            PolicyError: there is none, or it isn't what its card says.
        """
        self._folder = folder
        tensors, card = load(folder)
        self.sha256 = card.tensors_sha256
        self._tensors = {name: sha256_tensors({name: tensors[name]}) for name in tensors}

    def check(self) -> None:
        """Look again.

        Raises:
            FrozenError: a tensor changed, came or went; the message names it.
        """
        found = self._look()
        names = sorted(found.keys() | self._tensors.keys())
        changed = [name for name in names if found.get(name) != self._tensors.get(name)]
        if changed:
            raise FrozenError(
                f"the low level in {self._folder} changed since the learner started "
                f"({len(changed)} of {len(names)} tensors: {', '.join(changed[:3])}); "
                "restore it, or begin a new run folder"
            )

    def check_against(self, sha256: str) -> None:
        """Hold it against the low level that a version was made for.

        Raises:
            FrozenError: it is another one.
        """
        if sha256 != self.sha256:
            raise FrozenError(
                f"the versions in this store were made for the low level {sha256}, "
                f"but {self._folder} holds {self.sha256}; begin a new run folder"
            )

    def _look(self) -> dict[str, str]:
        try:
            tensors = load_file(self._folder / TENSORS_FILE)
        except (OSError, SafetensorError) as error:
            raise FrozenError(f"the low level in {self._folder} is unreadable: {error}") from None
        return {name: sha256_tensors({name: tensors[name]}) for name in tensors}
