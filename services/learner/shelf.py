"""Put each version on the disk as a checkpoint: for evaluations, exports and people."""

from pathlib import Path

from services.learner.descent import Descent, date, tell
from services.learner.store.store import PolicyRecord, Round
from services.learner.store.tensors import TensorFiles, unpack
from shared.messages.policy import Version
from shared.policies.checkpoint import CARD_FILE, Card, save

ROUND_FILE = "round.json"  # The round that made a version, beside its checkpoint.


class Shelf:
    """`versions/1.2/` and its like: what the robots ran, as `HighLevel.load` reads it.

    A version lies under the name that it was first announced by. A folder that has its name is
    whole: it is renamed into place.
    """

    def __init__(self, folder: Path, files: TensorFiles) -> None:
        self._folder, self._files = folder, files

    def put(self, record: PolicyRecord, came_of: Descent | Round | None) -> Path:
        """Write the checkpoint of a version, if it isn't there.

        came_of: or the round that made it; None: the run began with it.
        """
        name = str(Version(record.epoch, record.number))
        folder = self._folder / name
        if not isinstance(came_of, Descent):
            came_of = Descent(came_of)
        if not (folder / CARD_FILE).exists():
            tensors = {ref.name: unpack(ref, self._files.get(ref.sha256)) for ref in record.tensors}
            part = self._folder.with_name(f"version-{name}.part")
            save(part, tensors, _card(record, came_of))
            if came_of.round and came_of.again is None:
                (part / ROUND_FILE).write_text(came_of.round.model_dump_json(indent=2) + "\n")
            self._folder.mkdir(exist_ok=True)
            part.rename(folder)
        return folder


def _card(record: PolicyRecord, came_of: Descent) -> Card:
    version, round_ = str(Version(record.epoch, record.number)), came_of.round
    return Card(
        name="high_level",
        title=f"High level, version {version}",
        version=version,
        date=date(record.created_ns),
        recipe=tell(came_of),
        command="hld learner",
        seed=round_.seed if round_ else 0,
        data_sha256=str(round_.figures.get("labels_sha256", "")) if round_ else "",
        tensors_sha256="",
        settings={**record.settings, "bank": "\n".join(record.bank)},
    )
