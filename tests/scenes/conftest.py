"""Studies that are worked on in the test's own process, and quick conicities."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from study_workers import Here

from wheelrail.scenes.studies import run as run_module


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    workers = Here()
    monkeypatch.setattr(run_module, "processes", lambda count: workers)
    return workers


@pytest.fixture(scope="module")
def coarse_conicities() -> Iterator[None]:
    """Conicities of each step from few positions: they take a third of the time, and have tests of their own."""
    place = "wheelrail.contact.geometry.wheelset_conicity"
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(f"{place}.FINEST", 1e-3)
        patched.setattr(f"{place}.BEND", 1.0)
        yield
