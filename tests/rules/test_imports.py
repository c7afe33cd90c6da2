"""The direction of dependence, and the one home of each library, read from the source by `ast`."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

SMALL = {
    "shared.errors", "shared.clock", "shared.config", "shared.seeds", "shared.intervals",
    "shared.budget", "shared.code",
}  # fmt: skip
SERVICE = {"shared.telemetry", "shared.service"}

# Who may import what of ours; a package may always import itself. The longest prefix counts.
MAY_IMPORT = {
    "shared.errors": set(),
    "shared.clock": set(),
    "shared.intervals": set(),
    "shared.budget": set(),
    "shared.telemetry": set(),
    "shared.service": set(),
    "shared.seeds": {"shared.errors"},
    "shared.config": {"shared.errors"},
    "shared.messages": {"shared.errors"},
    "shared.wire": {"shared.messages", *SMALL},
    "shared.goals": {"shared.messages", *SMALL},
    "shared.policies": {"shared.goals", "shared.messages", *SMALL},
    "shared.checkpoints": set(),
    "shared.rollout": {"shared.policies", "shared.goals", "shared.messages", *SMALL},
    # The cell is one robot of the rollout, so it knows what a robot is; the rollout knows no cell.
    "shared.workcell": {"shared.rollout.robot", "shared.messages", *SMALL},
    # Evaluations run real policies in the real cell; actor and learner both make them.
    "shared.evaluation": {
        "shared.rollout", "shared.policies", "shared.goals", "shared.messages", "shared.workcell",
        *SMALL,
    },
    "services.actor": {"shared"},
    "services.correction_api": {"shared.messages", "shared.wire", *SMALL, *SERVICE},
    "services.learner": {"shared"},
    "services.oracle": {"shared.workcell", *SMALL, *SERVICE},
    "deploy": {"shared.wire", "shared.workcell", *SMALL, *SERVICE},
    "services": set(),
    "shared": set(),
}  # fmt: skip

# Who alone may import a library.
HOMES = {
    "zenoh": {"shared.wire"},
    "mujoco": {"shared.workcell"},
    "gymnasium": {"shared.workcell"},
    "sqlalchemy": {"services.learner.store", "services.correction_api.store"},
    "alembic": {"services.learner.store", "services.correction_api.store"},
    "fastapi": {"services.correction_api"},
    "starlette": {"services.correction_api"},
    "uvicorn": {"services.correction_api"},
    "torch": {
        "shared.goals", "shared.policies", "shared.evaluation", "services.learner",
        "services.actor",
    },
    "httpx": {"services.oracle", "deploy"},
    "pocketsphinx": {"services.correction_api.speech"},
    "faster_whisper": {"services.correction_api.speech"},
    "pickle": set(),
    "cloudpickle": set(),
    "dill": set(),
    "marshal": set(),
    "shelve": set(),
}  # fmt: skip

FILES = sorted(
    path
    for top in ("shared", "services", "deploy")
    for path in (ROOT / top).rglob("*.py")
)  # fmt: skip


def module_of(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


def imports_of(path: Path) -> Iterator[tuple[str, int]]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((name.name, node.lineno) for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are absolute"
            yield node.module or "", node.lineno


def within(module: str, package: str) -> bool:
    return module == package or module.startswith(package + ".")


def home_of(module: str) -> str:
    return max((name for name in MAY_IMPORT if within(module, name)), key=len)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_follow_the_direction_of_dependence(path):
    module = module_of(path)
    home = home_of(module)
    for imported, line in imports_of(path):
        if imported.split(".")[0] not in ("shared", "services", "deploy"):
            continue
        allowed = {home, *MAY_IMPORT[home]}
        assert any(within(imported, name) for name in allowed), (
            f"{path.relative_to(ROOT)}:{line}: {home} may not import {imported}"
        )


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_each_library_has_one_home(path):
    module = module_of(path)
    for imported, line in imports_of(path):
        homes = HOMES.get(imported.split(".")[0])
        assert homes is None or any(within(module, home) for home in homes), (
            f"{path.relative_to(ROOT)}:{line}: {imported} may be imported only in {sorted(homes)}"
        )


def test_the_rule_would_catch_a_service_that_imports_another():
    assert home_of("services.actor.act") == "services.actor"
    assert not any(within("services.learner", name) for name in MAY_IMPORT["services.actor"])


def test_no_source_file_outgrows_its_room():
    long = {
        str(path.relative_to(ROOT)): lines
        for path in FILES
        if (lines := len(path.read_text().splitlines())) > 300
    }
    assert not long, f"files of more than 300 lines: {long}"
