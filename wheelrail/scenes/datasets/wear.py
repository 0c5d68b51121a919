"""Results of wear: profiles, rates and measures over the steps, as one Dataset."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.wear.fatigue import direction
from wheelrail.contact.wear.strips import ProfileRates, total
from wheelrail.scenes.quantity import Quantity, Schema, filled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.vehicle.wear.evolution import WearingProfile
    from wheelrail.vehicle.wear.rates import MeanRates

CELLS, BY_CASE, OF_PROFILE, OF_CASE = ("profile", "s"), ("case", "profile", "s"), ("profile",), ("case",)
OF_RAIL, RAIL_CELLS = ("rail",), ("rail", "cell")
AMPLITUDE = 3e-3  # m, of the equivalent conicity

WEAR: Schema = {
    "profile": Quantity(OF_PROFILE, "", "profile: of all wheels, a side, a wheelset or a wheel"),
    "s": Quantity(("s",), "m", "arc length on the new profile, from the rolling circle to the field side"),
    "case": Quantity(OF_CASE, "", "case of the duty"),
    "new_y": Quantity(CELLS, "m", "middle of a cell on the new profile: lateral place, positive to the field side"),
    "new_z": Quantity(CELLS, "m", "the same: radius beyond that of the rolling circle"),
    "share": Quantity(OF_CASE, "1", "share of the distance"),
    "distance": Quantity((), "m", "travelled distance", label="distance", shown="km", digits=0),
    "removed_area": Quantity(CELLS, "m2", "section removed in a cell of the new profile"),
    "depth": Quantity(CELLS, "m", "mean depth removed in a cell", label="depth", shown="mm", digits=3),
    "depth_rate": Quantity(BY_CASE, "1", "depth removed per distance: m per m"),
    "energy_rate": Quantity(BY_CASE, "J/m3", "frictional energy per area and distance"),
    "fatigue_rate": Quantity(
        BY_CASE, "1/m", "surface fatigue index of passages that ratchet, per distance, smoothed as the wear of the step"
    ),
    "damage_rate": Quantity(BY_CASE, "1/m2", "T-gamma damage per width and distance, smoothed as the wear of the step"),
    "smoothing_length": Quantity(CELLS, "m", "length of the filter of the step"),
    "traction_direction": Quantity(CELLS, "rad", "mean direction of traction, from forward to the field side"),
    "area_rate": Quantity(CELLS, "m", "section removed in a cell per distance, of all cases"),
    "pressed_rate": Quantity(CELLS, "N/m", "the same times the pressure"),
    "outside_rate": Quantity(OF_PROFILE, "m2", "volume per distance beyond the ends of the profile"),
    "severe_share": Quantity(OF_PROFILE, "1", "share of the removed section in the severe branch of the law"),
    "step_error": Quantity(
        OF_PROFILE, "1", "half the change of rates over a step, over theirs: RMS", label="error", shown="%", digits=1
    ),
    "t_gamma": Quantity(OF_CASE, "N", "frictional power of a wheel over the speed, mean", label="T-gamma"),
    "energy_ratio": Quantity(OF_CASE, "1", "sum of the energy of cells over the frictional power, before balance"),
    "failed_share": Quantity(OF_CASE, "1", "share of wheels without a contact result"),
    "residual": Quantity(OF_CASE, "1", "largest unbalanced force of its equilibria over the mean wheel load"),
    "Sh": Quantity(OF_PROFILE, "m", "flange height", label="Sh", shown="mm", digits=2),
    "Sd": Quantity(OF_PROFILE, "m", "flange thickness", label="Sd", shown="mm", digits=2),
    "qR": Quantity(OF_PROFILE, "m", "flange gradient", label="qR", shown="mm", digits=2),
    "hollow": Quantity(OF_PROFILE, "m", "depth of a hollow tread", label="hollow", shown="mm", digits=2),
    "groove": Quantity(OF_PROFILE, "m", "least concave radius where the profile is worn, over 2 mm"),
    "rolling_radius": Quantity(OF_PROFILE, "m", "radius at the rolling circle", label="radius", shown="mm", digits=2),
    "removed_section": Quantity(OF_PROFILE, "m2", "removed section", label="section", shown="mm²", digits=2),
    "removed_mass": Quantity(OF_PROFILE, "kg", "removed mass of a wheel", label="mass", digits=3),
    "conicity": Quantity(
        (), "1", "equivalent conicity of EN 15302 at 3 mm, mean of the wheelsets", label="conicity", digits=3
    ),
    "rail": Quantity(OF_RAIL, "", "rail that wears"),
    "passages": Quantity((), "1", "wheelsets that passed the rails"),
    "rail_s": Quantity(RAIL_CELLS, "m", "arc length on the new rail, NaN beyond its cells"),
    "rail_new_y": Quantity(RAIL_CELLS, "m", "middle of a cell on the new rail: lateral place, positive to the field"),
    "rail_new_z": Quantity(RAIL_CELLS, "m", "the same: height above the top of the new rail"),
    "rail_removed_area": Quantity(RAIL_CELLS, "m2", "section removed in a cell of the new rail"),
    "rail_depth": Quantity(
        RAIL_CELLS, "m", "mean depth removed in a cell of a rail", label="depth", shown="mm", digits=3
    ),
    "rail_area_rate": Quantity(RAIL_CELLS, "m2", "section removed in a cell per passage of a wheelset"),
    "rail_pressed_rate": Quantity(RAIL_CELLS, "N", "the same times the pressure"),
    "rail_outside_rate": Quantity(OF_RAIL, "m2", "section per passage beyond the ends of the rail"),
    "rail_section": Quantity(OF_RAIL, "m2", "removed section of a rail", label="section", shown="mm²", digits=2),
    "W1": Quantity(OF_RAIL, "m", "vertical wear of a rail", label="W1", shown="mm", digits=3),
    "W3": Quantity(OF_RAIL, "m", "side wear of a rail, 14 mm below its new top", label="W3", shown="mm", digits=3),
    "turned": Quantity(OF_PROFILE, "1", "number of times that the wheels were turned to the new profile"),
    "seconds": Quantity((), "s", "computing time"),
}
MEASURES = ("Sh", "Sd", "qR", "hollow", "rolling_radius", "removed_section", "removed_mass")


def state_values(
    profiles: Mapping[str, WearingProfile],
    measures: Sequence[Any],
    distance: float,
    conicity: float,
    turned: Sequence[int],
) -> dict[str, Any]:
    """Values of the profiles at a distance, m.

    Parameters:
        profiles: by name.
        measures: `WheelMeasures` of each.
        distance: m.
        conicity: of the wheelset.
        turned: number of reprofilings of each.
    """
    return {
        "distance": distance,
        "turned": np.array(turned),
        "conicity": conicity,
        "removed_area": np.stack([own.removed for own in profiles.values()]),
        "depth": np.stack([own.depth for own in profiles.values()]),
        "groove": np.array([own.groove for own in profiles.values()]),
        **{name: np.array([getattr(own, name) for own in measures]) for name in MEASURES},
    }


def rate_values(
    profiles: Mapping[str, WearingProfile], cases: Sequence[MeanRates], shares: Sequence[float]
) -> tuple[dict[str, ProfileRates], dict[str, Any]]:
    """Rates of all cases by profile, and their values.

    Parameters:
        profiles: by name.
        cases: their rates.
        shares: of the distance.
    """
    by_case = [case.wheels for case in cases]
    sums = {name: total([means[name] for means in by_case], shares) for name in profiles}
    width = np.array([own.width for own in profiles.values()])[:, None]

    def cells(name: str) -> Any:
        return np.stack([[getattr(means[own], name) for own in profiles] for means in by_case]) / width

    def wheel(name: str) -> Any:
        return np.array([np.mean([getattr(means[own], name) for own in profiles]) for means in by_case])

    t_gamma = wheel("t_gamma")
    every = list(sums.values())
    removed = np.array([own.removed.sum() for own in every])
    severe = np.array([own.severe.sum() for own in every])
    return sums, {
        "depth_rate": cells("removed"),
        "energy_rate": cells("energy"),
        "fatigue_rate": np.stack([[means[own].fatigue_index for own in profiles] for means in by_case]),
        "damage_rate": cells("damage"),
        "traction_direction": np.stack([direction(own.traction) for own in every]),
        "area_rate": np.stack([own.removed for own in every]),
        "pressed_rate": np.stack([own.pressed for own in every]),
        "outside_rate": np.array([own.outside for own in every]),
        "severe_share": np.divide(severe, removed, out=np.zeros(len(removed)), where=removed > 0.0),
        "t_gamma": t_gamma,
        "energy_ratio": np.divide(wheel("unbalanced"), t_gamma, out=np.ones(len(t_gamma)), where=t_gamma > 0.0),
        "failed_share": np.array([case.failed_share for case in cases]),
        "residual": np.array([case.residual for case in cases]),
    }


def rail_state_values(rails: Mapping[str, WearingProfile], passages: float) -> dict[str, Any]:
    """Values of rails by name after passages of wheelsets; nothing without rails."""
    if not rails:
        return {}
    measures: list[Any] = [own.present.measures(own.new) for own in rails.values()]
    return {
        "passages": passages,
        "rail_removed_area": _padded([own.removed for own in rails.values()]),
        "rail_depth": _padded([own.depth for own in rails.values()]),
        "rail_section": np.array([own.removed_section for own in measures]),
        **{name: np.array([getattr(own, name) for own in measures]) for name in ("W1", "W3")},
    }


def rail_rate_values(rates: Collection[ProfileRates]) -> dict[str, Any]:
    """Values of the rates of rails; nothing without rails."""
    if not rates:
        return {}
    return {
        "rail_area_rate": _padded([own.removed for own in rates]),
        "rail_pressed_rate": _padded([own.pressed for own in rates]),
        "rail_outside_rate": np.array([own.outside for own in rates]),
    }


def _padded(rows: Sequence[Array]) -> Array:
    """Rows of different lengths as one array, NaN beyond their ends."""
    found = np.full((len(rows), max(map(len, rows))), np.nan)
    for own, row in zip(found, rows, strict=True):
        own[: len(row)] = row
    return found


def step_dataset(
    profiles: Mapping[str, WearingProfile],
    cases: Mapping[str, float],
    values: Mapping[str, Any],
    attributes: Mapping[str, Any],
    rails: Mapping[str, WearingProfile],
) -> Dataset:
    """Dataset of one step; values that it lacks are NaN.

    Parameters:
        profiles: by name.
        cases: shares by name.
        values: by name of WEAR.
        attributes: of the file.
        rails: those that wear, by name.
    """
    from xarray import Dataset

    first = next(iter(profiles.values()))
    middle = 0.5 * (first.grid.bounds[1:] + first.grid.bounds[:-1])
    points = np.stack([own.new.point(middle) for own in profiles.values()])
    sizes = {"profile": len(profiles), "s": len(first.removed), "case": len(cases)}
    coordinates = {
        "profile": list(profiles),
        "s": middle,
        "new_y": points[..., 0],
        "new_z": points[..., 1],
        "case": list(cases),
        "share": list(cases.values()),
    }
    if rails:
        middles = [0.5 * (own.grid.bounds[1:] + own.grid.bounds[:-1]) for own in rails.values()]
        places = [own.new.point(s) for own, s in zip(rails.values(), middles, strict=True)]
        coordinates |= {
            "rail": list(rails),
            "rail_s": _padded(middles),
            "rail_new_y": _padded([own[:, 0] for own in places]),
            "rail_new_z": _padded([own[:, 1] for own in places]),
        }
        sizes |= {"rail": len(rails), "cell": max(map(len, middles))}
    nothing = {
        name: np.full([sizes[dim] for dim in own.dims], np.nan)
        for name, own in WEAR.items()
        if name not in coordinates and sizes.keys() >= set(own.dims) and (rails or name != "passages")
    }
    return Dataset(filled(WEAR, {**nothing, **values}), coords=filled(WEAR, coordinates), attrs=dict(attributes))


def joined(steps: Sequence[Dataset]) -> Dataset:
    """One Dataset over the dimension step; attributes are those of the last one."""
    from xarray import concat

    shared = [name for name in WEAR if name in steps[0].coords]
    known = [step[[name for name in WEAR if name in step.data_vars]] for step in steps]
    data = concat(known, "step", coords="minimal", compat="override", join="override")
    coordinates = {"step": np.arange(len(steps)), **{name: steps[0][name] for name in shared}}
    return data.assign_coords(coordinates).assign_attrs(steps[-1].attrs)
