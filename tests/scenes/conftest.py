"""Studies that are worked on in the test's own process."""

from __future__ import annotations

import pytest
from study_workers import Here

from wheelrail.scenes.studies import run as run_module


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    workers = Here()
    monkeypatch.setattr(run_module, "processes", lambda count: workers)
    return workers
