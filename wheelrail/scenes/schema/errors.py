"""Errors of a scene: one in its text, and a run that cannot be completed."""

from __future__ import annotations


class SceneError(ValueError):
    """A scene that cannot be used."""


class RunFailed(RuntimeError):
    """A run that came to nothing."""
