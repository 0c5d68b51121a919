"""Discretisation of bodies and contact, and the allowed combinations of choices."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from wheelrail.contact.models.lattice.resolution import LatticeResolution

Model = Literal["condensed", "full"]
Bodies = Literal["solid", "waveguide", "half-space"]
Points = Literal["lattice", "grid"]
Cell = Literal["tetrahedron", "hexahedron"]
DEGREE: dict[Bodies, int] = {"solid": 1, "waveguide": 2, "half-space": 0}


class IncompatibleChoice(ValueError):
    """Choice incompatible with other choices of the discretisation.

    Parameters:
        key: the field of `Discretisation`.
        allowed: its allowed values.
    """

    def __init__(self, key: str, allowed: str) -> None:
        super().__init__(f"{key} must be {allowed}")
        self.key, self.allowed = key, allowed


@dataclass(frozen=True)
class Discretisation:
    """Model, bodies, contact points and elements; None is replaced by `for_laws`.

    Parameters:
        surface_size: spacing of the nodes or lines of the surface in contact, m.
        model: "condensed" solves for tractions on the surface compliance, "full" for all displacements.
        bodies: meshed solids, bodies invariant along the track or about the axle by wavenumbers, or half-spaces.
        points: strips of a "lattice" fixed on the upper body, or a regular "grid".
        degree: of the displacements, 1 or 2; 0 is 1 for solids, 2 for waveguides.
        cell: of solids.
        slip_order: of the difference formula for the slip on a grid, 1 or 2.
        strips, cells: of a lattice, over the width of a usual patch and along a strip; None is the default of
            `LatticeResolution`.
    """

    surface_size: float
    model: Model = "condensed"
    bodies: Bodies | None = None
    points: Points | None = None
    degree: int = 0
    cell: Cell = "tetrahedron"
    slip_order: int = 2
    strips: int | None = None
    cells: int | None = None

    def for_laws(self, *, exact: bool) -> Discretisation:
        """The discretisation with all choices made.

        Parameters:
            exact: whether the normal law is exact: a penalty needs a grid.

        Raises IncompatibleChoice.
        """
        meshed = not exact or self.model == "full" or self.cell == "hexahedron"
        bodies: Bodies = self.bodies or ("solid" if meshed else "waveguide")
        strips = bodies != "solid" and exact
        points: Points = self.points or ("lattice" if strips else "grid")
        if bodies != "solid" and (self.model == "full" or self.cell == "hexahedron"):
            raise IncompatibleChoice("bodies", '"solid" with model = "full" or hexahedra, which need meshes in 3D')
        if bodies == "half-space" and points == "grid":
            raise IncompatibleChoice("bodies", '"half-space" needs points = "lattice" and the exact normal law')
        if points == "lattice" and not strips:
            needs = 'bodies = "waveguide" and laws = "exact", or stiffness_per_area = inf'
            raise IncompatibleChoice("points", f'"lattice" needs {needs}')
        for key in ("strips", "cells"):
            if getattr(self, key) is not None and points == "grid":
                raise IncompatibleChoice(key, 'only with points = "lattice"')
        if self.slip_order == 1 and points != "grid":
            raise IncompatibleChoice("slip_order", '1 only with points = "grid"; strips have second order')
        return replace(self, bodies=bodies, points=points, degree=self.degree or DEGREE[bodies])

    @property
    def resolution(self) -> LatticeResolution:
        """Strips and cells of a lattice. Raises ValueError for too few."""
        from wheelrail.contact.models.lattice.resolution import LatticeResolution

        numbers = {"strips": self.strips, "cells": self.cells}
        return LatticeResolution(**{key: number for key, number in numbers.items() if number is not None})
