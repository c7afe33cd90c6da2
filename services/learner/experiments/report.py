"""The report of an experiment: report.json for machines, and the same as report.md for people."""

import json
from pathlib import Path
from typing import Any

from services.learner.experiments.findings import Findings, Table
from services.learner.experiments.plots import draw

SCHEMA = 1


def write(folder: Path, findings: Findings, about: dict[str, Any]) -> None:
    """Write report.json, report.md and the plots. about: what was asked for, and when."""
    names = [draw(folder, plot) for plot in findings.plots]
    told = findings.model_dump(mode="json", exclude={"first"})
    first = {name: told["figures"][name] for name in findings.first}
    content = {"schema": SCHEMA, **about, **first, **told, "pictures": names}
    text = json.dumps(content, indent=2, ensure_ascii=False)
    (folder / "report.json").write_text(text + "\n")
    (folder / "report.md").write_text(describe(findings, about, names))


def describe(findings: Findings, about: dict[str, Any], pictures: list[str]) -> str:
    """The report as a page."""
    lines = [f"# {findings.title}", "", *findings.method, ""]
    lines += [f"`{about['command']}`, {about['date']}, at {about['site']}{_policies(about)}."]
    for table in findings.tables:
        lines += ["", f"## {table.title}", "", *_table(table)]
    for plot, name in zip(findings.plots, pictures, strict=True):
        lines += ["", f"![{plot.title}]({name})"]
    if findings.notes:
        lines += ["", "## To be known", *(f"- {note}" for note in findings.notes)]
    return "\n".join(lines) + "\n"


def _policies(about: dict[str, Any]) -> str:
    """The policies that were given, if any were."""
    names = []
    if about["low_level_sha256"]:
        names.append(f"π_LL `{about['low_level_sha256'][:12]}`")
    if about["high_level_sha256"]:
        names.append(f"π_HL {about['high_level']} `{about['high_level_sha256'][:12]}`")
    return f"; {', '.join(names)}" if names else ""


def _table(table: Table) -> list[str]:
    rows = [table.columns, ("---",) * len(table.columns), *table.rows]
    return [f"| {' | '.join(row)} |" for row in rows]
