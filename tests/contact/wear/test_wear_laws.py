"""Laws of wear: limits, published coefficients, continuity, and messages for what is wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from wheelrail.contact.wear.law_tables import LAWS, law_from
from wheelrail.contact.wear.laws import (
    DENSITY,
    HARDNESS,
    Archard,
    Energy,
    Kth,
    PearceSherratt,
    SlidingCells,
    TGamma,
    Usfd,
    WearLaw,
    WearTable,
    Zone,
)
from wheelrail.support.arrays import Array

FRICTION, SPEED = 0.3, 20.0


def sliding(pressure: float | Array = 1e9, slip: float | Array = 1e-3, t_gamma: float | Array = 50.0) -> SlidingCells:
    """Cells with tractions at the bound."""
    p, w, t = (np.atleast_1d(part).astype(float) for part in np.broadcast_arrays(pressure, slip, t_gamma))
    return SlidingCells(p, FRICTION * p * w, np.full(len(p), FRICTION), w * SPEED, SPEED, t)


@pytest.mark.parametrize(
    ("law", "expected"),
    [  # kg/J in the mild regime, of tables by the group's own units
        (Usfd(), 5.3e-9),
        (Archard(k=1e-4), 9.69135802469136e-10),
        (Archard(k=1e-3), 9.69135802469136e-9),
        (PearceSherratt(), 6.165375582669969e-9),
        (Energy(), 7e-10),
        (WearTable(points=((10.4e6, 0.055),)), 0.055 / 10.4e6),
    ],
)
def test_mild_wear_per_energy(law: WearLaw, expected: float) -> None:
    cells = sliding(slip=5e-5)
    assert law.rate(cells) / cells.dissipation * DENSITY == pytest.approx(expected, rel=1e-12)
    assert not law.severe(cells).any()


def test_archard_is_pressure_times_slip() -> None:
    pressure, slip = np.array([1e8, 1e9]), np.array([1e-3, 2e-2])
    assert Archard(k=5e-4).rate(sliding(pressure, slip)) == pytest.approx(5e-4 * pressure * slip / HARDNESS)


def test_kth_map_has_its_regimes_and_a_plastic_limit() -> None:
    law = Kth()
    velocity = np.array([0.1, 0.4, 1.0, 0.4])
    assert law.coefficient(np.array([1e9, 1e9, 1e9, 2.5e9]), velocity) == pytest.approx([5.5e-4, 35e-4, 5.5e-4, 350e-4])
    above = sliding(np.array([HARDNESS, 5.0 * HARDNESS]), np.array([1e-3, 1e-3]))
    assert law.rate(above)[0] == pytest.approx(law.rate(above)[1])
    assert law.severe(above).all()
    assert not Kth(limit=2e9).severe(above).any()


@pytest.mark.parametrize("law", [Kth(), Energy(), Usfd(), PearceSherratt()])
def test_rates_do_not_jump(law: WearLaw) -> None:
    """A change by 1e-5 changes rates by 2e-3 at most, over all regimes of slip, pressure and T-gamma."""
    grow = np.exp(np.arange(0.0, 9.0, 1e-5))
    for cells in (sliding(slip=1e-4 * grow), sliding(pressure=1e7 * grow), sliding(t_gamma=grow)):
        rate = law.rate(cells)
        assert (rate > 0.0).all()
        assert np.abs(np.diff(np.log(rate))).max() < 2e-3


def test_usfd_continues_its_severe_branch() -> None:
    q = np.array([77.2, 87.2])  # N/mm2
    cells = sliding(slip=q * 1e6 / (FRICTION * 1e9))
    assert Usfd().rate(cells) * DENSITY * 1e3 == pytest.approx([55.0, 55.0 + 61.9 * 10.0])
    assert Usfd().severe(sliding(slip=np.array([77.1, 77.3]) * 1e6 / (FRICTION * 1e9))).tolist() == [False, True]


def test_a_global_law_sums_to_its_volume() -> None:
    """Cells with shares of the energy of a patch get these shares of its volume."""
    cells = sliding(slip=np.array([1e-3, 3e-3]), t_gamma=150.0)
    volume = law_from({"name": "t-gamma", "points": [[100.0, 1e-10], [200.0, 3e-10]]}).rate(cells)
    assert volume / cells.dissipation == pytest.approx(2e-10 / 150.0)


def test_zones_scale_by_angle_and_place() -> None:
    law = Usfd(scale=0.5, zones=(Zone(factor=0.1, angle=(0.5, 1.6)), Zone(factor=2.0, s=(0.0, 0.01))))
    angle, s, width = np.array([0.0, 1.2, 0.0, 0.5]), np.array([-0.01, -0.03, 0.0, -0.03]), np.full(4, 1e-3)
    assert law.factors(angle, s, width) == pytest.approx([0.5, 0.05, 0.75, 0.275])


def test_laws_come_from_tables() -> None:
    assert law_from({"name": "usfd", "scale": 0.18}) == Usfd(scale=0.18)
    assert law_from({"points": [[1e6, 1e-3]]}) == WearTable(points=((0.0, 0.0), (1e6, 1e-3)))
    zones = [{"factor": 0.1, "angle": [0.5, 1.6]}]
    assert law_from({"name": "kth", "zones": zones}).zones == (Zone(factor=0.1, angle=(0.5, 1.6)),)
    for name, law in LAWS.items():
        table = {"name": name} | ({"points": [[1.0, 1.0]]} if law in (WearTable, TGamma) else {})
        assert type(law_from(table)) is law
        assert law.source


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"name": "ushd"}, "law: name = 'ushd': must be one of archard, kth, usfd, energy, table"),
        ({"scale": 1.0}, "law: name = None: must be one of"),
        ({"name": "archard", "hardness": 0}, "law: hardness = 0: must be a finite number, positive"),
        ({"name": "archard", "k": float("nan")}, "law: k = nan: must be a finite number, positive"),
        ({"name": "usfd", "scale": -1.0}, "law: scale = -1.0: must be a finite number, positive"),
        ({"name": "usfd", "scale": "0.2"}, "law: scale = '0.2': must be a finite number, positive"),
        ({"name": "usfd", "scale": True}, "law: scale = True: must be a finite number, positive"),
        ({"name": "usfd", "hardness": 1e9}, "law: hardness: unknown for usfd, which has density, scale, zones"),
        ({"name": "usfd", "points": [[1, 2]]}, "law: points: unknown for usfd"),
        ({"name": "table"}, "law: points: missing"),
        ({"points": [[2.0, 1.0], [1.0, 2.0]]}, r"law: points = \[\[2.0, 1.0\], \[1.0, 2.0\]\]: q must ascend"),
        ({"points": [[0.0, 1.0], [1.0, 2.0]]}, "K must be 0 at q = 0"),
        ({"points": [[1.0, float("nan")]]}, "q and K must be finite and not negative"),
        ({"points": [1.0, 2.0]}, r"must be pairs \[q, K\] of numbers"),
        ({"points": [[1.0, "x"]]}, r"must be pairs \[q, K\] of numbers"),
        ({"points": [[1.0, 2.0], [2.0, 1.0]]}, "K must not fall at the end"),
        ({"name": "kth", "slow": 0.8}, "law: slow = 0.8 m/s: must be below fast = 0.7 m/s"),
        ({"name": "usfd", "zones": {"flange": 0.1}}, "must be a list of tables"),
        ({"name": "usfd", "zones": [{"angle": [0.1, 0.2]}]}, "zone: factor: missing"),
        ({"name": "usfd", "zones": [{"factor": 0.1}]}, "zone: needs angle"),
        (
            {"name": "usfd", "zones": [{"factor": -0.1, "s": [0, 1]}]},
            "zone: factor = -0.1: must be a finite number, at",
        ),
        ({"name": "usfd", "zones": [{"factor": 0.1, "angle": [0.2, 0.1]}]}, "zone: angle = .*two ascending numbers of"),
        ({"name": "usfd", "zones": [{"factor": 0.1, "s": 3}]}, "zone: s = 3: must be two ascending numbers, m"),
        ({"name": "usfd", "zones": [{"factor": 0.1, "place": 3}]}, "zone: place: unknown"),
    ],
)
def test_wrong_tables_are_named(table: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        law_from(table)
