"""Contact geometry of rigid profiles: rolling radii, contact points and equivalent conicity over the displacement."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from wheelrail.api.rigid_pair import contact_values, rigid_wheelset
from wheelrail.contact.geometry.first_contact import FirstContact, RigidWheelset, first_contacts_over
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

FINEST = 1e-4  # m, largest spacing of the lateral positions for the equivalent conicity


# Variable by side: unit, meaning.
BY_SIDE = {
    "rolling_radius": ("m", "rolling radius"),
    "contact_angle": ("rad", "contact angle, rotation of the contact plane about the track direction"),
    "wheel_s": ("m", "arc length on the wheel profile from the rolling circle, positive to the field side"),
    "wheel_y": ("m", "lateral position on the wheel from the rolling circle, positive to the field side"),
    "rail_s": ("m", "arc length on the rail profile from the top of the inclined rail, positive to the field side"),
    "rail_y": ("m", "lateral position on the rail from the top of the inclined rail, positive to the field side"),
    "contact_x": ("m", "longitudinal position of the contact point, ahead of the axle"),
}


def contact_geometry(
    wheel: str | Path | Profile = "S1002",
    rail: str | Path | Profile = "UIC60",
    y: ArrayLike | None = None,
    *,
    yaw: float = 0.0,
    **more: Any,
) -> Dataset:
    """Contact points of a rigid wheelset on rigid rails over its lateral position, and the equivalent conicity.

    Parameters:
        wheel, rail: name, file or profile.
        y: (n,) lateral positions of the wheelset, m, positive to the left; -6 to 6 mm in steps of 0.1 mm by default.
        yaw: of the wheelset, rad.
        more: mounting as for `wheelrail.Wheelset`: laying_angle, rad; gauge, gauge_height, flange_back_distance,
            flange_back and radius, m; left and right, what differs on one side.

    Returns a Dataset over y and side: rolling_radius, m, contact_angle, rad, contact points on both profiles, m; over
    y: height z, m, and roll, rad, of the wheelset, rolling_radius_difference, m, left minus right; over amplitude, m,
    the positive values of y: equivalent_conicity, that of conical wheels with the same wavelength of the kinematic
    motion (EN 15302; Klingel's formula for cones), with sides that differ about the position of equal rolling radii.

    Raises SceneError, and ValueError for a position without contact on both sides.
    """
    from xarray import Dataset

    from wheelrail.scenes.datasets.patches import means

    positions = _positions(y)
    wheelset = rigid_wheelset(wheel, rail, **more)
    contacts = first_contacts_over(wheelset, positions, yaw)
    values = _by_side(wheelset, [touches for _, touches in contacts])
    radii = values["rolling_radius"]
    amplitude = np.unique(positions[positions > 0.0])
    return Dataset(
        {
            **{name: (("y", "side"), values[name], means(units, text)) for name, (units, text) in BY_SIDE.items()},
            "z": (
                "y",
                [state.z for state, _ in contacts],
                means("m", "height of the wheelset above its nominal height"),
            ),
            "roll": ("y", [state.roll for state, _ in contacts], means("rad", "roll of the wheelset")),
            "rolling_radius_difference": (
                "y",
                radii[:, 0] - radii[:, 1],
                means("m", "rolling radius difference, left minus right"),
            ),
            "equivalent_conicity": (
                "amplitude",
                _conicity(wheelset, amplitude),
                means("1", "equivalent conicity, from the wavelength of the kinematic motion (EN 15302)"),
            ),
        },
        coords={
            "y": ("y", positions, means("m", "lateral position of the wheelset, positive to the left")),
            "side": ("side", list(SIDES)),
            "amplitude": ("amplitude", amplitude, means("m", "amplitude of the lateral motion")),
        },
        attrs={
            "title": "Contact geometry of rigid profiles",
            **_names(wheelset),
            "base": 2.0 * wheelset.mounting.wheel_y,
            "nominal_radius": wheelset.mounting.radius,
            "yaw": yaw,
        },
    )


def _positions(y: ArrayLike | None) -> Array:
    """Lateral positions (n,) m of the wheelset, -6 to 6 mm unless given. Raises ValueError for others than numbers."""
    places = np.atleast_1d(np.asarray(np.linspace(-6e-3, 6e-3, 121) if y is None else y, dtype=np.float64))
    if places.ndim != 1 or not np.isfinite(places).all() or np.abs(places).max(initial=0.0) > 0.1:
        raise ValueError(f"y must be numbers from -0.1 to 0.1 m (2 mm is 0.002), got {y!r}")
    return places


def _names(wheelset: RigidWheelset) -> dict[str, str]:
    """Names of the profiles, by side where they differ."""
    sides = {side: wheelset.on(side).pair for side in SIDES}
    named = {
        "wheel": {s: pair.wheel.name for s, pair in sides.items()},
        "rail": {s: pair.rail.name for s, pair in sides.items()},
    }
    return {
        body: names["left"] if wheelset.right is None else ", ".join(f"{name} ({s})" for s, name in names.items())
        for body, names in named.items()
    }


def _by_side(wheelset: RigidWheelset, touches: Sequence[Mapping[Side, FirstContact]]) -> dict[str, Array]:
    """Variables (n, 2) of the contact points of both sides at n positions."""
    values = {name: np.empty((len(touches), len(SIDES))) for name in BY_SIDE}
    for row, touch in enumerate(touches):
        for column, side in enumerate(SIDES):
            for name, value in contact_values(wheelset, touch[side], side).items():
                values[name][row, column] = value
    return values


def _conicity(wheelset: RigidWheelset, amplitude: Array) -> Array:
    """Equivalent conicity (n,) at amplitudes (n,) m, in order."""
    from wheelrail.contact.geometry.conicity import equivalent_conicity

    if not amplitude.size:
        return np.empty(0)
    steps = max(2, int(np.ceil(amplitude[-1] / FINEST)))
    fine = amplitude[-1] * (np.arange(steps + 1) if wheelset.right is None else np.arange(-steps, steps + 1)) / steps
    touches = [touch for _, touch in first_contacts_over(wheelset, fine)]
    left, right = (
        np.array([contact_values(wheelset, touch[side], side)["rolling_radius"] for touch in touches]) for side in SIDES
    )
    base, radius = 2.0 * wheelset.mounting.wheel_y, wheelset.mounting.radius
    return equivalent_conicity(fine, left - right, amplitude, base=base, radius=radius)
