"""The scenes that come with the package."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from wheelrail.scenes.schema.errors import SceneError

FOLDER = Path(__file__).parents[1] / "examples"


def examples() -> dict[str, str]:
    """By name, what each is."""
    return {file.stem: _heading(file) for file in sorted(FOLDER.glob("*.toml"))}


def example(name: str) -> str:
    """The text of one; raises SceneError naming the ones there are."""
    if name not in examples():
        raise SceneError(f"NAME = {name!r}: must be one of {', '.join(examples())}")
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def _heading(file: Path) -> str:
    """The first sentence of the comment that a file starts with."""
    lines = takewhile(lambda line: line.startswith("# "), file.read_text(encoding="utf-8").splitlines())
    return " ".join(line[1:].strip() for line in lines).split(". ")[0].rstrip(".")
