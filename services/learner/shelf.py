"""Put each version on the disk as a checkpoint: for evaluations, exports and people."""

from datetime import UTC, datetime
from pathlib import Path

from services.learner.store.store import PolicyRecord, Round
from services.learner.store.tensors import TensorFiles, unpack
from shared.messages.policy import Version
from shared.policies.checkpoint import CARD_FILE, Card, save

ROUND_FILE = "round.json"  # What the version was made from, beside its checkpoint.


class Shelf:
    """`versions/1.2/` and its like: what the robots ran, as `HighLevel.load` reads it.

    A version lies under the name that it was first announced by. A folder that has its name is
    whole: it is renamed into place.
    """

    def __init__(self, folder: Path, files: TensorFiles) -> None:
        self._folder, self._files = folder, files

    def put(self, record: PolicyRecord, round_: Round | None) -> Path:
        """Write the checkpoint of a version, if it isn't there; `round_` made it, if one did."""
        name = str(Version(record.epoch, record.number))
        folder = self._folder / name
        if not (folder / CARD_FILE).exists():
            tensors = {ref.name: unpack(ref, self._files.get(ref.sha256)) for ref in record.tensors}
            part = self._folder.with_name(f"version-{name}.part")
            save(part, tensors, _card(record, round_))
            if round_:
                (part / ROUND_FILE).write_text(round_.model_dump_json(indent=2) + "\n")
            self._folder.mkdir(exist_ok=True)
            part.rename(folder)
        return folder


def _card(record: PolicyRecord, round_: Round | None) -> Card:
    version = str(Version(record.epoch, record.number))
    return Card(
        name="high_level",
        title=f"High level, version {version}",
        version=version,
        date=datetime.fromtimestamp(record.created_ns / 1e9, UTC).date().isoformat(),
        recipe=_recipe(round_),
        command="hld learner",
        seed=round_.seed if round_ else 0,
        data_sha256=str(round_.figures.get("labels_sha256", "")) if round_ else "",
        tensors_sha256="",
        settings={**record.settings, "bank": "\n".join(record.bank)},
    )


def _recipe(round_: Round | None) -> tuple[str, ...]:
    if round_ is None:
        return ("The checkpoint that the run began with, unchanged.",)
    figures = round_.figures
    return (
        f"Round {round_.number}, from the version number {round_.parent} of the same run.",
        f"Fine-tuned on the demonstrations and {figures.get('labels')} labels of all rounds so "
        f"far; the data hash is that of the labels.",
        f"Settings: {round_.manifest.settings.get('train')}.",
    )
