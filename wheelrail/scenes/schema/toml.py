"""Reading of TOML files."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.text_file import FileRefused
from wheelrail.support.text_file import read_text as text_of

MOST = 1.0  # MB


def read_text(path: Path) -> str:
    """Text of a file; raises SceneError if it cannot be read."""
    try:
        return text_of(path, MOST)
    except FileRefused as error:
        raise SceneError(str(error)) from None


def parse(text: str, path: str | Path) -> dict[str, Any]:
    """Tables of a TOML text; raises SceneError for another text, naming path."""
    try:
        return tomllib.loads(text)
    except ValueError as error:  # of TOML syntax, or of a number with thousands of digits
        raise SceneError(f"{path}: not valid TOML: {error}") from None
    except RecursionError:
        raise SceneError(f"{path}: not valid TOML: brackets nested hundreds of levels deep") from None
