"""Reports: measured figures that come with the service, or that an experiment wrote since.

Read anew at each question, since an experiment may have ended meanwhile; small files, seldom asked.
"""

import json
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from services.correction_api.problems import Problem
from shared.errors import nearest

EXPERIMENTS = ("horizon", "replanning", "transitions")
MAX_BYTES = 8 << 20
SHIPPED = files("services.correction_api.measured")


class Evaluation(NamedTuple):
    """Success of a version on evaluation seeds, without people."""

    success: float
    n: int
    low: float
    high: float


class Reports:
    """folder: of experiments, each as NAME/report.json or NAME.json. evaluations: of reports of
    `hld evaluate`, one a version, named by it. None: there are none but those that come with it."""

    def __init__(self, folder: Path | None, evaluations: Path | None) -> None:
        self._folder, self._evaluations = folder, evaluations

    def listed(self) -> dict[str, str]:
        """The experiments, each with what to do where it was not measured yet; "" where it was."""
        return {name: "" if self._find(name) else _hint(name) for name in EXPERIMENTS}

    def experiment(self, name: str) -> dict[str, Any]:
        """The report of an experiment.

        Raises:
            Problem: 404, there is no such experiment, or it was not measured yet.
        """
        if name not in EXPERIMENTS:
            detail = f"no experiment {name[:64]!r}{nearest(name[:64], EXPERIMENTS)}"
            raise Problem(404, "unknown-report", "No such report", detail)
        if (found := self._find(name)) is None:
            raise Problem(404, "not-measured", "Not measured yet", _hint(name))
        return found

    def _find(self, name: str) -> dict[str, Any] | None:
        """What was measured here comes before what the service brings along."""
        for path in self._places(name):
            if (found := _read(path)) is not None and "figures" in found:
                return found
        shipped = SHIPPED / f"{name}.json"
        return dict(json.loads(shipped.read_text())) if shipped.is_file() else None

    def evaluations(self) -> dict[str, Evaluation]:
        """Success by version, such as "1.2", where it was evaluated."""
        if self._evaluations is None or not self._evaluations.is_dir():
            return {}
        found = {}
        for path in sorted(self._evaluations.glob("[0-9]*.[0-9]*.json")):
            if not path.stem.replace(".", "", 1).isdecimal():
                continue
            if evaluation := _evaluation(_read(path) or {}):
                found[path.stem] = evaluation
        return found

    def _places(self, name: str) -> list[Path]:
        if self._folder is None:
            return []
        return [self._folder / name / "report.json", self._folder / f"{name}.json"]


def _hint(name: str) -> str:
    run = f"hld experiment {name} --out DIR/{name}"
    return (
        f"not measured yet: run {run}, and start the API with --set reports=DIR "
        "(hld up: --set api.reports=DIR)"
    )


def _evaluation(report: dict[str, Any]) -> Evaluation | None:
    """None where it is another kind of report."""
    try:
        low, high = report["interval"]
        return Evaluation(float(report["success"]), int(report["n"]), float(low), float(high))
    except (KeyError, TypeError, ValueError):
        return None


def _read(path: Path) -> dict[str, Any] | None:
    """A JSON object; None where there is none, or only half of one so far."""
    try:
        if path.stat().st_size > MAX_BYTES:
            return None
        content = json.loads(path.read_text())
    except (OSError, ValueError):
        return None
    return content if isinstance(content, dict) else None
