"""Errors of scenes and runs."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene, or another input, is invalid; the message names file, key, value and what is allowed."""


class RunFailed(RuntimeError):
    """A run or a solve ended without results."""
