"""Rails that wear under the passages of wheelsets: two of each entry of the duty, with a clock of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.wear.strips import ProfileRates, total
from wheelrail.scenes.wear.schema import DutyTable
from wheelrail.vehicle.wear.evolution import WearingRail

Rails = Mapping[str, WearingRail]  # by name


def rail_names(entry: str, table: DutyTable, hand: int = 1) -> dict[Side, str]:
    """Names of the rails of a case: inner and outer in a steady curve, left and right otherwise.

    Parameters:
        entry: title of the case in the duty.
        table: of the case.
        hand: -1: the curve is mirrored.
    """
    bend = 0.0 if table.steady is None else hand * table.steady.curvature
    left, right = {0.0: SIDES, 1.0: ("inner", "outer"), -1.0: ("outer", "inner")}[float(np.sign(bend))]
    return {"left": f"{entry}, {left} rail", "right": f"{entry}, {right} rail"}


def rail_rates(
    rails: Rails, passages: Sequence[Mapping[str, ProfileRates]], shares: Sequence[float]
) -> dict[str, ProfileRates]:
    """Rates of each rail per passage of a wheelset, mean of its cases.

    Parameters:
        rails: by name.
        passages: mean rates of the cases, by rail.
        shares: of the distance, of the cases.
    """
    found = {}
    for name in rails:
        own = [(rates[name], share) for rates, share in zip(passages, shares, strict=True) if name in rates]
        whole = sum(share for _, share in own)
        found[name] = total([rates for rates, _ in own], [share / whole for _, share in own])
    return found


def stored_rail_rates(rails: Rails, step: Mapping[Any, Any]) -> dict[str, ProfileRates]:
    """Removed sections and pressures of each rail of a stored step; other rates are NaN."""
    found = {}
    for number, (name, own) in enumerate(rails.items()):
        cells = slice(len(own.profile.removed))
        removed, pressed = (np.asarray(step[f"rail_{key}_rate"])[number, cells] for key in ("area", "pressed"))
        found[name] = ProfileRates.of_sections(removed, pressed, float(step["rail_outside_rate"][number]))
    return found
