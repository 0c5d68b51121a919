"""Quantities of results: what readers see fits what files hold."""

from __future__ import annotations

import pytest

from wheelrail.scenes.quantities import CONTACT, CYCLE, READERS, RUN, SAFETY, SOLUTION
from wheelrail.scenes.quantity import SCALES, Quantity
from wheelrail.scenes.studies.quantities import MAIN, QUANTITIES

EVERY = [entry for table in (RUN, CONTACT, SOLUTION, QUANTITIES, CYCLE, SAFETY) for entry in table.items()]


def test_shown_units_are_those_of_the_si_unit() -> None:
    for name, quantity in EVERY:
        if quantity.shown in SCALES:
            assert SCALES[quantity.shown][0] == quantity.unit, name


def test_labels_belong_to_quantities() -> None:
    assert set(READERS) <= {name for name, _ in EVERY}
    assert all(QUANTITIES[name].label and QUANTITIES[name].shown for name in MAIN)


def test_texts_for_readers() -> None:
    force = RUN["lateral_force"]
    assert (force.axis, force.head) == ("Y, positive to the left [kN]", "lateral force [kN]")
    assert force.name == "lateral force Y, positive to the left"
    assert force.texts([-1234.5, -0.001]) == "-1.23  0.00"
    assert RUN["derailment_quotient"].axis == "Y/Q [1]"
    assert QUANTITIES["largest_car_body_roll"].head == "largest car body roll [mrad]"
    assert QUANTITIES["max_pressure"].scale == pytest.approx(1e-6)
    assert Quantity(("side",)).attributes == {}
