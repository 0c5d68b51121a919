"""Reading TOML files, with errors that name them."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from scenes.complaint import SceneError


def read_text(path: Path) -> str:
    """Raises SceneError for a file that cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise SceneError(f"{path}: not a text file in UTF-8 (byte {error.start})") from None


def parse(text: str, path: str | Path) -> dict[str, Any]:
    """Raises SceneError for a text that is not TOML; path names it."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SceneError(f"{path}: not valid TOML: {error}") from None
