"""Settings of a service: one frozen model; defaults < TOML file < HLD_… environment < --set.

An unknown key is an error that names the nearest one, wherever it was written.
"""

import json
import os
import sys
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel, ConfigDict, SecretStr, ValidationError

from shared.errors import ConfigError, nearest

Tree = dict[str, Any]


class Settings(BaseModel):
    """Base of every settings model, also of the nested ones."""

    model_config = ConfigDict(frozen=True, extra="forbid")


S = TypeVar("S", bound=Settings)


def load(
    model: type[S],
    section: str,
    *,
    file: Path | None = None,
    sets: Iterable[str] = (),
    environment: Mapping[str, str] | None = None,
) -> S:
    """Build the settings of `section` (a service's name).

    file: TOML with one table per service; a missing table means defaults.
    sets: "a.b=c", where c is JSON or else a plain string.
    environment: `HLD_<SECTION>_A__B=c` sets a.b; the process's own by default.

    Raises:
        ConfigError: a key is unknown or a value is out of range; the message says which.
    """
    tree: Tree = dict(_read_table(file, section)) if file else {}
    _merge(tree, _from_environment(os.environ if environment is None else environment, section))
    for assignment in sets:
        _merge(tree, _parse_set(assignment))
    try:
        return model.model_validate(tree)
    except ValidationError as error:
        raise ConfigError(_explain(error, model, section)) from None


def load_or_exit(model: type[S], section: str, **sources: Any) -> S:
    """Like `load`, for a command line: says what is wrong and ends with exit code 2."""
    try:
        return load(model, section, **sources)
    except ConfigError as error:
        exit_misconfigured(section, error)


def exit_misconfigured(section: str, error: Exception) -> NoReturn:
    """Say what is wrong in one line and end with exit code 2, which no restart can mend."""
    print(f"{section}: {error}", file=sys.stderr, flush=True)
    raise SystemExit(2) from None


def make_folder(folder: Path) -> None:
    """Make a folder for what is to be written, before the work of it begins.

    Raises:
        ConfigError: it can't be made, or not be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"cannot write into {folder}: {error.strerror}") from None
    if not os.access(folder, os.W_OK):
        raise ConfigError(f"cannot write into {folder}: it is read-only for this user")


def _read_table(file: Path, section: str) -> Tree:
    try:
        tables = tomllib.loads(file.read_text())
    except OSError as error:
        raise ConfigError(f"cannot read {file}: {error.strerror}") from None
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{file} is no TOML: {error}") from None
    table = tables.get(section, {})
    if not isinstance(table, dict):
        raise ConfigError(f"{file}: [{section}] must be a table")
    return table


def _from_environment(environment: Mapping[str, str], section: str) -> Tree:
    prefix = f"HLD_{section.upper().replace('-', '_')}_"
    tree: Tree = {}
    for name, value in environment.items():
        if name.startswith(prefix):
            path = name.removeprefix(prefix).lower().split("__")
            _merge(tree, _nest(path, _parse_value(value)))
    return tree


def _parse_set(assignment: str) -> Tree:
    path, equals, value = assignment.partition("=")
    if not equals or not path:
        raise ConfigError(f"--set takes KEY=VALUE, such as round.episodes=40, not {assignment!r}")
    return _nest(path.strip().split("."), _parse_value(value))


def _parse_value(text: str) -> Any:
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def _nest(path: list[str], value: Any) -> Tree:
    for key in reversed(path):
        value = {key: value}
    return dict(value)


def _merge(tree: Tree, over: Tree) -> None:
    for key, value in over.items():
        if isinstance(value, dict) and isinstance(tree.get(key), dict):
            tree[key] = dict(tree[key])
            _merge(tree[key], value)
        else:
            tree[key] = value


def _explain(error: ValidationError, model: type[BaseModel], section: str) -> str:
    lines = []
    for problem in error.errors():
        path = ".".join(str(part) for part in problem["loc"])
        if problem["type"] == "extra_forbidden":
            hint = nearest(path, _known(model))
            lines.append(f"unknown key {path!r} for the {section}{hint}")
        else:
            where = f"{section}.{path}" if path else section
            lines.append(f"{where}: {problem['msg']}{_given(problem, model)}")
    return "; ".join(lines)


def _given(problem: Any, model: type[BaseModel]) -> str:
    """What was given instead, unless it is all settings together, or may be a secret."""
    place = problem["loc"]
    field = model.model_fields.get(str(place[0])) if place else None
    hidden = field is None or SecretStr.__name__ in repr(field)
    return "" if hidden else f", not {problem['input']!r}"


def _known(model: type[BaseModel], prefix: str = "") -> list[str]:
    names = []
    for name, field in model.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            names += _known(kind, f"{prefix}{name}.")
        else:
            names.append(prefix + name)
    return names
