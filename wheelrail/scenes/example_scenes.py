"""Example scenes of the package."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from wheelrail.scenes.schema.errors import SceneError

FOLDER = Path(__file__).parent / "examples"


def examples() -> dict[str, str]:
    """Heading by name."""
    return {file.stem: _heading(file) for file in sorted(FOLDER.glob("*.toml"))}


def example(name: str) -> str:
    """Text of an example; raises SceneError for another name."""
    if name not in examples():
        raise SceneError(f"NAME = {name!r}: must be one of {', '.join(examples())}")
    return (FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def _heading(file: Path) -> str:
    """First sentence of the initial comment of a file."""
    lines = takewhile(lambda line: line.startswith("# "), file.read_text(encoding="utf-8").splitlines())
    return " ".join(line[1:].strip() for line in lines).split(". ")[0].rstrip(".")
