"""Import system that hides all installed packages but those that the dependencies of an extra bring along."""

from __future__ import annotations

import re
import sys
import sysconfig
import tomllib
from collections.abc import Iterable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from importlib.metadata import PackageNotFoundError, distributions, requires
from pathlib import Path
from types import ModuleType
from typing import Any

from packaging.requirements import Requirement

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def _name(text: str) -> str:
    return re.sub(r"[-_.]+", "-", text).lower()


def brought_along(requirements: Iterable[str]) -> set[str]:
    """Names of all packages that an installation of the requirements contains, as the installed metadata say."""
    todo, seen = [Requirement(text) for text in requirements], set[tuple[str, frozenset[str]]]()
    while todo:
        wanted = todo.pop()
        extras = frozenset(wanted.extras)
        if (_name(wanted.name), extras) in seen:
            continue
        seen.add((_name(wanted.name), extras))
        try:
            further = map(Requirement, requires(wanted.name) or [])
        except PackageNotFoundError:
            continue
        todo += [
            one
            for one in further
            if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in ("", *extras))
        ]
    return {name for name, _ in seen}


def hidden_from(*extras: str) -> set[str]:
    """Modules of this virtual environment that the extras do not bring along; those of the system stay."""
    optional = PROJECT["optional-dependencies"]
    wanted = [*PROJECT["dependencies"], *(text for name in extras for text in optional[name])]
    allowed = brought_along([*wanted, "pip", "setuptools"])  # which venv installs by itself
    here, theirs = set[str](), set[str]()
    for package in distributions(path=[sysconfig.get_path("purelib")]):
        modules = {file.parts[0].partition(".")[0] for file in package.files or () if file.suffix in (".py", ".so")}
        (theirs if _name(package.metadata["Name"]) in {*allowed, PROJECT["name"]} else here).update(modules)
    return here - theirs


class WithoutModules:
    """Path finder that does not find the modules of a set."""

    def __init__(self, hidden: set[str]) -> None:
        self.hidden = hidden

    def __getattr__(self, name: str) -> Any:
        return getattr(PathFinder, name)

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        return None if name.partition(".")[0] in self.hidden else PathFinder.find_spec(name, path, target)


def only(*extras: str) -> None:
    """Let this process see the dependencies of the extras alone; to be called before any other import."""
    finder: Any = WithoutModules(hidden_from(*extras))
    sys.meta_path = [finder if one is PathFinder else one for one in sys.meta_path]
