"""The memory of fine surfaces and of many strips is told before anything is meshed or solved, and refused beyond the
machine's.
"""

from __future__ import annotations

import logging

import pytest
from small_strips import few_strips

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice import model as lattice
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


def machine_of(pages: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Memory of so many pages of 4096 bytes."""
    monkeypatch.setattr("wheelrail.support.memory.os.sysconf", lambda name: 4096 if "SIZE" in name else pages)


def test_solids_beyond_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    machine_of(4_000_000, monkeypatch)
    size = r"surface_size: 401 x 955 nodes on the surface of the wheel"
    with pytest.raises(TooLarge, match=size + r": about 1.06e\+04 GB .* this machine has 16.4 GB"):
        PAIR.solid_grids(Discretisation(1e-4).for_laws(exact=False))


def test_large_solids_are_told(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    machine_of(10_000_000, monkeypatch)
    with caplog.at_level(logging.INFO, "wheelrail"), pytest.raises(AssertionError, match="meshed"):
        PAIR.solid_grids(Discretisation(5e-4).for_laws(exact=False))
    (wheel,) = [record.getMessage() for record in caplog.records]
    assert wheel == "surface_size: 81 x 191 nodes on the surface of the wheel: about 1.2 GB of memory or more"
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


def test_many_strips_are_told_and_refused(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    contact, state = few_strips(), WheelsetState(z=-3e-4, speed=20.0, pitch_rate=20.0 / 0.46)
    machine_of(100, monkeypatch)  # 0.4 MB
    with pytest.raises(TooLarge, match=r"^\d+ strips, 8 cells along each: \d+ unknowns: about .* GB of memory or more"):
        contact(state, "left")
    machine_of(1_000_000, monkeypatch)
    monkeypatch.setattr(lattice, "LONG", 0.0)
    with caplog.at_level(logging.INFO, "wheelrail"):
        assert contact(state, "left").ok
    (message,) = [record.getMessage() for record in caplog.records]
    assert message.endswith(" s per Newton step")
