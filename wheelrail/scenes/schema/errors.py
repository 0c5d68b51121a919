"""Errors of scenes and runs."""

from __future__ import annotations

from wheelrail.support.text_file import abridged


class SceneError(ValueError):
    """A scene, or another input, is invalid; the message names file, key, value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(abridged(message))


class RunFailed(RuntimeError):
    """A run or a solve ended without results."""
