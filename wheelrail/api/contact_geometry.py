"""Contact geometry of rigid profiles: rolling radii, contact points and equivalent conicity over the displacement."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wheelrail.api.rigid_pair import contact_values, rigid_wheelset
from wheelrail.contact.geometry.first_contact import (
    FirstContact,
    RigidWheelset,
    contact_without_roll,
    first_contacts_over,
)
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.quantities import PATCH
from wheelrail.scenes.quantity import Quantity, Schema, filled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

FINEST = 1e-4  # m, largest spacing of the lateral positions for the equivalent conicity
BEND = 2e-5  # m, of the rolling radius difference from a line between positions, which are closer above it, down to
NARROW = 2e-6  # m
BEYOND = (5e-3, 4e-3, 3e-3, 2e-3, 1e-3, 0.0)  # m, tried in this order


BY_SIDE = ("y", "side")
GEOMETRY: Schema = {
    "y": Quantity(("y",), "m", "lateral position of the wheelset, positive to the left"),
    "side": Quantity(("side",), "", ""),
    "amplitude": Quantity(("amplitude",), "m", "amplitude of the lateral motion"),
    "rolling_radius": Quantity(BY_SIDE, "m", "rolling radius"),
    "contact_angle": PATCH["patch_contact_angle"]._replace(dims=BY_SIDE),
    **{name: PATCH[name]._replace(dims=BY_SIDE) for name in ("wheel_s", "wheel_y", "rail_s", "rail_y")},
    "contact_x": Quantity(BY_SIDE, "m", "longitudinal position of the contact point, ahead of the axle"),
    "z": Quantity(("y",), "m", "height of the wheelset above its nominal height"),
    "roll": Quantity(("y",), "rad", "roll of the wheelset"),
    "rolling_radius_difference": Quantity(("y",), "m", "rolling radius difference, left minus right"),
    "equivalent_conicity": Quantity(("amplitude",), "1", "equivalent conicity without roll of the wheelset (EN 15302)"),
    "equivalent_conicity_with_roll": Quantity(
        ("amplitude",), "1", "equivalent conicity with the roll of the wheelset on both rails"
    ),
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
    the positive values of y: equivalent_conicity of EN 15302, whose wheels are lowered to the rails without roll of the
    wheelset, and equivalent_conicity_with_roll of the wheelset that touches both rails. Both are those of cones with
    the same wavelength of the kinematic motion, 0 where no motion of that amplitude returns, and with sides that differ
    about the position of equal rolling radii. They are computed when they are first read.

    Raises SceneError, and ValueError for a position without contact on both sides.
    """
    from xarray import Dataset

    positions = _positions(y)
    wheelset = rigid_wheelset(wheel, rail, **more)
    contacts = first_contacts_over(wheelset, positions, yaw)
    values = _by_side(wheelset, [touches for _, touches in contacts])
    radii = values["rolling_radius"]
    amplitude = np.unique(positions[positions > 0.0])
    conicity = {
        name: _on_demand(amplitude.shape, partial(_conicity, wheelset, amplitude, difference))
        for name, difference in (
            ("equivalent_conicity", _difference_without_roll),
            ("equivalent_conicity_with_roll", _difference_with_roll),
        )
    }
    places = {"y": positions, "side": list(SIDES), "amplitude": amplitude}
    variables = {
        **values,
        "z": [state.z for state, _ in contacts],
        "roll": [state.roll for state, _ in contacts],
        "rolling_radius_difference": radii[:, 0] - radii[:, 1],
        **conicity,
    }
    return Dataset(
        filled(GEOMETRY, variables),
        coords=filled(GEOMETRY, places),
        attrs={
            "title": "Contact geometry of rigid profiles",
            **_names(wheelset),
            "base": 2.0 * wheelset.mounting.wheel_y,
            "nominal_radius": wheelset.mounting.radius,
            "yaw": yaw,
        },
    )


def _on_demand(shape: tuple[int, ...], compute: Callable[[], Array]) -> Any:
    """Data of a variable of xarray in place of an array.

    Parameters:
        shape: of the values.
        compute: the values; called at most once.
    """
    from xarray.backends import BackendArray
    from xarray.core import indexing

    class Values(BackendArray):
        """Array that is computed at the first index."""

        def __init__(self) -> None:
            self.shape, self.dtype = shape, np.dtype(np.float64)

        def __getitem__(self, key: Any) -> Any:
            support = indexing.IndexingSupport.OUTER
            return indexing.explicit_indexing_adapter(key, self.shape, support, lambda own: compute()[own])

        def __reduce__(self) -> Any:
            """As computed values: a copy in another process has no other way to them."""
            return indexing.NumpyIndexingAdapter, (compute(),)

    return indexing.MemoryCachedArray(indexing.LazilyIndexedArray(Values()))  # type: ignore[no-untyped-call]


def _positions(y: ArrayLike | None) -> Array:
    """Lateral positions (n,) m of the wheelset, -6 to 6 mm unless given. Raises ValueError for others than numbers."""
    places = np.atleast_1d(np.asarray(np.linspace(-6e-3, 6e-3, 121) if y is None else y, dtype=np.float64))
    if places.ndim != 1 or not np.isfinite(places).all() or np.abs(places).max(initial=0.0) > 0.1:
        raise ValueError(f"y must be numbers from -0.1 to 0.1 m (2 mm is 0.002), got {y!r}")
    return places


def _names(wheelset: RigidWheelset) -> dict[str, str]:
    """Profile names by body, and by side where left and right differ."""
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
    names = [name for name, own in GEOMETRY.items() if own.dims == BY_SIDE]
    values = {name: np.empty((len(touches), len(SIDES))) for name in names}
    for row, touch in enumerate(touches):
        for column, side in enumerate(SIDES):
            for name, value in contact_values(wheelset, touch[side], side).items():
                values[name][row, column] = value
    return values


def _difference_with_roll(wheelset: RigidWheelset, y: Array) -> Array:
    """Rolling radius difference (n,) m at positions (n,) m of the wheelset that touches both rails."""
    touches = [touch for _, touch in first_contacts_over(wheelset, y)]
    left, right = (np.array([_rolling_radius(wheelset.on(side), touch[side]) for touch in touches]) for side in SIDES)
    return np.asarray(left - right)


def _difference_without_roll(wheelset: RigidWheelset, y: Array) -> Array:
    """Rolling radius difference (n,) m at positions (n,) m of a wheelset that does not roll."""
    left, right = (
        np.array([_rolling_radius(pair, contact_without_roll(pair, at)) for at in (hand * y).tolist()])
        for pair, hand in ((wheelset, 1.0), (wheelset.on("right"), -1.0))
    )
    return np.asarray(left - right)


def _rolling_radius(wheelset: RigidWheelset, touch: FirstContact) -> float:
    return wheelset.pair.radius + float(wheelset.pair.wheel.point(touch.wheel_s)[1])


def _conicity(
    wheelset: RigidWheelset, amplitude: Array, difference_at: Callable[[RigidWheelset, Array], Array]
) -> Array:
    """Equivalent conicity (n,) at amplitudes (n,) m, in order.

    Parameters:
        wheelset: profiles and mounting.
        amplitude: (n,) m.
        difference_at: rolling radius difference (n,) m of the wheelset at positions (n,) m.

    The difference is sampled closer across its jumps and bends.
    """
    from wheelrail.contact.geometry.conicity import equivalent_conicity

    if not amplitude.size:
        return np.empty(0)
    y, difference = _sampled(wheelset, float(amplitude[-1]), difference_at)
    while len(wide := np.flatnonzero(_bent(y, difference) & (np.diff(y) > NARROW))):
        between = 0.5 * (y[wide] + y[wide + 1])
        difference = np.insert(difference, wide + 1, difference_at(wheelset, between))
        y = np.insert(y, wide + 1, between)
    base, radius = 2.0 * wheelset.mounting.wheel_y, wheelset.mounting.radius
    return equivalent_conicity(y, difference, amplitude, base=base, radius=radius)


def _bent(y: Array, difference: Array) -> NDArray[np.bool_]:
    """Which of the (n - 1) intervals between positions have an end away from the line between its neighbours."""
    part = np.diff(y)[:-1] / (y[2:] - y[:-2])
    away = np.abs(difference[:-2] + part * (difference[2:] - difference[:-2]) - difference[1:-1]) > BEND
    return np.asarray(np.concatenate([[False], away]) | np.concatenate([away, [False]]))


def _sampled(
    wheelset: RigidWheelset, amplitude: float, difference_at: Callable[[RigidWheelset, Array], Array]
) -> tuple[Array, Array]:
    """Positions (n,) m at most FINEST apart up to an amplitude m, and the rolling radius difference there.

    They start from 0 where the sides are alike. Sides that differ swing about another position, so that theirs reach
    farther to both sides, by BEYOND or as far as both wheels touch.
    """
    if wheelset.right is None:
        y = np.linspace(0.0, amplitude, max(2, int(np.ceil(amplitude / FINEST))) + 1)
        return y, difference_at(wheelset, y)
    for farther in BEYOND:
        reach = amplitude + farther
        y = np.linspace(-reach, reach, 2 * max(2, int(np.ceil(reach / FINEST))) + 1)
        try:
            return y, difference_at(wheelset, y)
        except ValueError:
            if farther == 0.0:
                raise
    raise AssertionError
