"""Contact geometry of rigid profiles: rolling radii, contact points and equivalent conicity over the displacement."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from wheelrail.api.rigid_pair import contact_values, rigid_wheelset
from wheelrail.contact.geometry.first_contact import FirstContact, RigidWheelset, first_contacts_over
from wheelrail.contact.geometry.wheelset_conicity import (
    difference_with_roll,
    difference_without_roll,
    wheelset_conicity,
)
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.quantities import PATCH
from wheelrail.scenes.quantity import Quantity, Schema, filled
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset

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
        name: _on_demand(amplitude.shape, partial(wheelset_conicity, wheelset, amplitude, difference))
        for name, difference in (
            ("equivalent_conicity", difference_without_roll),
            ("equivalent_conicity_with_roll", difference_with_roll),
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
