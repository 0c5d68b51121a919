"""The memory of fine surfaces of wheel and rail is told before anything is meshed, and refused beyond the machine's."""

from __future__ import annotations

import logging

import pytest

from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.profile_bodies import ProfileBodies
from wheelrail.meshes.bodies import solids
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.memory import TooLarge

PAIR = ProfileBodies((named_profile("S1002"), named_profile("60E1")), 0.46, (Material(), Material()))


@pytest.fixture(autouse=True)
def unmeshed(monkeypatch: pytest.MonkeyPatch) -> None:
    def meshed(*_: object, **__: object) -> None:
        raise AssertionError("meshed")

    monkeypatch.setattr(solids, "stored", meshed)


def test_solids_beyond_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wheelrail.support.memory.os.sysconf", lambda name: 4096 if "SIZE" in name else 4_000_000)
    pattern = r"surface_size: 401 x 955 nodes on the surface of the wheel: about 85.9 GB .* this machine has 16.4 GB"
    with pytest.raises(TooLarge, match=pattern):
        PAIR.solid_grids(Discretisation(1e-4).for_laws(exact=False))


def test_large_solids_are_told(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "wheelrail"), pytest.raises(AssertionError, match="meshed"):
        PAIR.solid_grids(Discretisation(3e-4).for_laws(exact=False))
    wheel, rail = [record.getMessage() for record in caplog.records]
    assert wheel.startswith("surface_size: 135 x 31")
    assert rail.startswith("surface_size: 135 x 2")
    assert wheel.endswith(" GB of memory or more")
    caplog.clear()
    with caplog.at_level(logging.INFO, "wheelrail"), pytest.raises(AssertionError, match="meshed"):
        PAIR.solid_grids(Discretisation(1e-3).for_laws(exact=False))
    assert not caplog.records


def test_fine_lines_of_waveguides_are_told(caplog: pytest.LogCaptureFixture) -> None:
    how = Discretisation(1e-4).for_laws(exact=True)
    with caplog.at_level(logging.INFO, "wheelrail"):
        next(PAIR._waveguides(how))  # meshed when a compliance is first asked for
    wheel, rail = [record.getMessage() for record in caplog.records]
    assert wheel == "surface_size: 801 x 955 nodes on the surface of the wheel: about 2.6 GB of memory or more"
    assert rail.startswith("surface_size: 801 x 787 nodes on the surface of the rail")
