"""Torques of motors and brakes, and forces on the bodies of a vehicle, in a scene of a run."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field, Strict, field_validator, model_validator

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.tables import SceneTable

if TYPE_CHECKING:
    from wheelrail.vehicle.loads.load_table import LoadTable

At = Annotated[q.Finite, q.Range(0.0, 1e5, "s or m", "time, or distance that the vehicle has run")]
Torque = Annotated[q.Finite, q.Range(-1e6, 1e6, "N m", "on a wheelset: 3 kN m is 3e3")]
Force = Annotated[q.Finite, q.Range(-1e8, 1e8, "N", "20 kN is 20e3")]
Torques = Annotated[
    tuple[Annotated[tuple[At, Torque], Strict(False)], ...], Strict(False), Field(min_length=1), q.AtMost(10_000)
]
Forces = Annotated[
    tuple[Annotated[tuple[At, Force], Strict(False)], ...], Strict(False), Field(min_length=1), q.AtMost(10_000)
]
Along = Annotated[q.Finite, q.Range(-100.0, 100.0, "m", "forward of the vehicle's reference point")]
Across = Annotated[q.Finite, q.Range(-10.0, 10.0, "m", "to the left")]
Height = Annotated[q.Finite, q.Range(-5.0, 10.0, "m", "above top of rail")]
Points = tuple[tuple[float, float], ...]


def _increasing(value: float | Points) -> float | Points:
    if isinstance(value, tuple) and any(later <= at for (at, _), (later, _) in pairwise(value)):
        raise q.reject("must have points with strictly increasing times or distances")
    return value


class LoadsTable(SceneTable):
    """Values over time, s, or the distance that the vehicle has run, m; linear between points, constant outside."""

    over: Literal["time", "distance"] = "time"

    def table(self, value: float | Points) -> LoadTable:
        """Values for `vehicle`."""
        from wheelrail.vehicle.loads.load_table import LoadTable

        return LoadTable(value if isinstance(value, tuple) else ((0.0, value),), self.over == "distance")


class TorqueTable(LoadsTable):
    """Torque of a motor or brake on each of some wheelsets, N m, or points [s or m, N m].

    A motor's is positive forwards; that of a friction brake is a magnitude and acts against the rotation. The opposite
    torque acts on the body that carries motor or brake.
    """

    kind: Literal["motor", "brake"]
    torque: Torque | Torques
    wheelsets: Annotated[tuple[str, ...], Strict(False), Field(min_length=1)] | None = None
    reaction: str | None = None

    _points = field_validator("torque")(_increasing)

    @model_validator(mode="after")
    def _magnitude(self) -> TorqueTable:
        values = [value for _, value in self.torque] if isinstance(self.torque, tuple) else [self.torque]
        if self.kind == "brake" and min(values) < 0.0:
            text = 'must not be negative with kind = "brake", whose torque acts against the rotation of the wheelset'
            raise q.reject(text, "torque")
        return self


class BodyForceTable(LoadsTable):
    """Force at a point of a body, m, along the axes of the track there, N, or points [s or m, N]."""

    body: str
    point: Annotated[tuple[Along, Across, Height], Strict(False)]
    longitudinal: Force | Forces = 0.0
    lateral: Force | Forces = 0.0
    vertical: Force | Forces = 0.0

    _points = field_validator("longitudinal", "lateral", "vertical")(_increasing)
