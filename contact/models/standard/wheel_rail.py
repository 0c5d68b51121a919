"""Forces of wheels on rails with Piotrowski and Kik's pressures, all wheels of a side in one compiled call; their
derivatives in one more, and the patches of a wheel, on demand, from the interpenetration regions of the forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions, WheelRegions, wheel_regions
from wheelrail.contact.geometry.line_scan import Lines
from wheelrail.contact.geometry.wheel_surface import profile_places, wheel_points
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import Dimensions, WheelPairs, by_states, left_pairs, velocities_of
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity
from wheelrail.contact.models.standard.force_derivatives import force_derivatives
from wheelrail.contact.models.standard.forces import StripFrames, StripFriction, strip_forces
from wheelrail.contact.models.standard.normal import StripPressures, virtual_penetration
from wheelrail.contact.models.standard.patches import patch_rows
from wheelrail.contact.models.standard.pressure_derivatives import virtual_penetration_derivatives
from wheelrail.contact.models.standard.region_derivatives import region_derivatives
from wheelrail.contact.models.standard.strip_loads import strip_loads
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.meshes.curves.closest_point import Shape
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled


class Parameters(NamedTuple):
    """What is the same for all wheels of a pair of profiles.

    Parameters:
        wheel, rail, radius, lines, merge: as for `wheel_regions`.
        elastic: constants of both bodies.
        method: of the tangential problem, see `StripFriction`.
        mu: friction coefficient.
        reduction: factors of Polach's formula.
        cells: along each strip.
    """

    wheel: Shape
    rail: Shape
    radius: float
    lines: Lines
    merge: float
    elastic: PairElasticity
    method: int
    mu: float
    reduction: tuple[float, float]
    cells: int


class WheelForces(NamedTuple):
    """Forces of w wheels, and the regions of all.

    Parameters:
        wrench: (w, 6) force N and moment N m.
        values: (w, 8), largest penetration m; 1 for a wheel inside the rail or over an end of a profile, otherwise 0;
            numbers of contacts and of cells; largest semi-axes m along and across; smallest rolling speed m/s; largest
            pressure Pa.
        starts: (w + 1, 6) first rows of each wheel in the arrays that follow.
        top, low, edges, contacts, contact, strips: those of `WheelRegions`, wheel after wheel.
    """

    wrench: Array
    values: Array
    starts: Nodes
    top: Array
    low: Array
    edges: Array
    contacts: Array
    contact: Nodes
    strips: Array


@compiled
def penetration_regions(found: WheelRegions) -> PenetrationRegions:
    """Contacts and strips as columns."""
    contacts, strips = found.contacts, found.strips
    return PenetrationRegions(
        contacts[:, 0],
        contacts[:, 1],
        contacts[:, 2],
        contacts[:, 3],
        found.contact,
        strips[:, 0],
        strips[:, 1],
        strips[:, 2],
        strips[:, 3],
        strips[:, 4],
    )


@compiled
def strip_frames(
    p: Parameters, origin: Array, rotation: Array, zones: PenetrationRegions, strips: StripPressures
) -> tuple[StripFrames, StripFrames]:
    """Frames on the wheel's surface in the middles of strips, and at the maxima of the penetration."""
    middles, axes = wheel_points(p.wheel, p.radius, origin, rotation, strips.s, strips.x)
    peaks, peak_axes = wheel_points(p.wheel, p.radius, origin, rotation, zones.peak, zones.peak_x)
    return StripFrames(middles, axes), StripFrames(peaks, peak_axes)


@compiled
def store_force(
    p: Parameters, origin: Array, rotation: Array, v: RigidVelocities, wrench: Array, values: Array
) -> WheelRegions:
    """Regions of a wheel; its force and moment about the rail's origin, and its values are filled, see `WheelForces`.

    Parameters:
        p: of the pair.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        v: rigid motion of wheel and rail.
        wrench, values: (6,) and (8,), zeros.
    """
    found = wheel_regions(p.wheel, p.rail, p.radius, origin, rotation, p.lines, p.merge)
    values[0], values[1], values[2] = found.approach, 1.0 if found.beyond else 0.0, len(found.contacts)
    values[3] = len(found.contact) * p.cells
    if len(found.contacts) > 0:
        zones = penetration_regions(found)
        strips = virtual_penetration(zones, p.elastic.E_star)
        middles, peaks = strip_frames(p, origin, rotation, zones, strips)
        friction = p.method, p.mu, p.reduction, p.cells
        values[6] = strip_loads(strips, zones, middles, peaks, v, p.elastic, friction, wrench[:3], wrench[3:])
        values[4], values[5] = strips.along.max(), strips.across.max()
        values[7] = (strips.scale * strips.half).max()
    return found


@compiled
def wheel_forces(p: Parameters, pairs: WheelPairs, mirror: bool) -> WheelForces:
    """Forces of all wheels and moments about the pairs' centres; of the mirror images, if these are asked for.

    Parameters:
        p: of the pair.
        pairs: poses and motions.
        mirror: whether forces and moments are those in the mirror y = 0; regions are those of the pairs.
    """
    w = len(pairs.origin)
    wrench, values, starts = np.zeros((w, 6)), np.zeros((w, 8)), np.zeros((w + 1, 6), np.int64)
    all_found = []
    for i in range(w):
        v = velocities_of(pairs.motion[i])
        found = store_force(p, pairs.origin[i], pairs.rotation[i], v, wrench[i], values[i])
        sizes = len(found.top), len(found.low), len(found.edges), len(found.contacts), len(found.contact)
        for k in range(6):
            starts[i + 1, k] = starts[i, k] + sizes[min(k, 4)]
        (fx, fy, fz), c = (wrench[i, 0], wrench[i, 1], wrench[i, 2]), pairs.centre[i]
        wrench[i, 3] -= c[1] * fz - c[2] * fy
        wrench[i, 4] -= c[2] * fx - c[0] * fz
        wrench[i, 5] -= c[0] * fy - c[1] * fx
        if mirror:
            wrench[i, 1], wrench[i, 3], wrench[i, 5] = -wrench[i, 1], -wrench[i, 3], -wrench[i, 5]
        all_found.append(found)
    n = starts[w]
    forces = WheelForces(
        wrench,
        values,
        starts,
        np.empty((n[0], 3)),
        np.empty((n[1], 3)),
        np.empty(n[2]),
        np.empty((n[3], 4)),
        np.empty(n[4], np.int64),
        np.empty((n[5], 5)),
    )
    for i in range(w):
        a, b, found = starts[i], starts[i + 1], all_found[i]
        forces.top[a[0] : b[0]], forces.low[a[1] : b[1]], forces.edges[a[2] : b[2]] = found.top, found.low, found.edges
        forces.contacts[a[3] : b[3]], forces.contact[a[4] : b[4]] = found.contacts, found.contact
        forces.strips[a[5] : b[5]] = found.strips
    return forces


@compiled
def regions_of(forces: WheelForces, i: int) -> WheelRegions:
    """Regions of wheel i."""
    a, b = forces.starts[i], forces.starts[i + 1]
    return WheelRegions(
        forces.values[i, 0],
        forces.values[i, 1] > 0.0,
        forces.top[a[0] : b[0]],
        forces.low[a[1] : b[1]],
        forces.edges[a[2] : b[2]],
        forces.contacts[a[3] : b[3]],
        forces.contact[a[4] : b[4]],
        forces.strips[a[5] : b[5]],
    )


@compiled
def forces_in_states(
    p: Parameters, states: Array, dimensions: Dimensions, mirror: bool
) -> tuple[WheelPairs, WheelForces]:
    """Pairs and forces of one side of wheelsets.

    Parameters:
        p: of the pair.
        states: (w, 17), values of `WheelsetState`.
        dimensions: of wheelset and track.
        mirror: whether the side is the right one.
    """
    pairs = left_pairs(states, dimensions, mirror)
    return pairs, wheel_forces(p, pairs, mirror)


@compiled
def wheel_tangents(p: Parameters, pairs: WheelPairs, forces: WheelForces, wheels: Nodes) -> Array:
    """Derivatives (m, 6, 12) of forces and moments about the rail's origin, with FASTSIM or without friction; zero for
    wheels without contact.

    Parameters:
        p, pairs: as for `wheel_forces`.
        forces: at these poses and motions.
        wheels: (m,) indices of the wheels; -1: none, without contact.
    """
    result = np.zeros((len(wheels), 6, 12))
    for m in range(len(wheels)):
        i = wheels[m]
        if i < 0 or forces.values[i, 2] == 0.0:
            continue
        found, origin, rotation = regions_of(forces, i), pairs.origin[i], pairs.rotation[i]
        zones = penetration_regions(found)
        strips = virtual_penetration(zones, p.elastic.E_star)
        by_zones = region_derivatives(p.wheel, p.rail, p.radius, origin, rotation, p.lines.s, p.merge, found)
        by_strips = virtual_penetration_derivatives(zones, strips, by_zones)
        frames, v = strip_frames(p, origin, rotation, zones, strips), velocities_of(pairs.motion[i])
        pose, of_pair = (origin, rotation), (p.elastic, p.mu, p.cells)
        result[m] = force_derivatives(p.wheel, p.radius, pose, zones, strips, frames, v, *of_pair, by_zones, by_strips)
    return result


@compiled
def tangents_in_states(
    p: Parameters,
    pairs: WheelPairs,
    forces: WheelForces,
    wheels: Nodes,
    states: Array,
    dimensions: Dimensions,
    mirror: bool,
) -> Array:
    """Derivatives (m, 6, 9) of forces and moments by the coordinates of wheelsets.

    Parameters as for `wheel_tangents` and `forces_in_states`, whose results these are.
    """
    tangents, wrenches = wheel_tangents(p, pairs, forces, wheels), np.zeros((len(wheels), 6))
    for m in range(len(wheels)):
        if wheels[m] >= 0:
            wrenches[m], c = forces.wrench[wheels[m]], pairs.centre[wheels[m]]
            for q in range(12):
                x, y, z = tangents[m, 0, q], tangents[m, 1, q], tangents[m, 2, q]
                tangents[m, 3, q] -= c[1] * z - c[2] * y
                tangents[m, 4, q] -= c[2] * x - c[0] * z
                tangents[m, 5, q] -= c[0] * y - c[1] * x
    return by_states(tangents, wrenches, states, dimensions[0], mirror)


@compiled
def wheel_patches(p: Parameters, pairs: WheelPairs, forces: WheelForces, i: int) -> Array:
    """Rows of all patches of wheel i by decreasing load, see `wheelrail.contact.results.patch_sums.patches_of`.

    Parameters as for `wheel_tangents`.
    """
    found, origin, rotation = regions_of(forces, i), pairs.origin[i], pairs.rotation[i]
    zones, v = penetration_regions(found), velocities_of(pairs.motion[i])
    strips = virtual_penetration(zones, p.elastic.E_star)
    middles, peaks = strip_frames(p, origin, rotation, zones, strips)
    friction = StripFriction(
        p.method, np.full(len(strips.s) * p.cells, p.mu), np.full(len(zones.peak), p.mu), p.reduction
    )
    tractions = strip_forces(strips, zones.weight, middles, peaks, v, p.elastic, friction, p.cells)
    places = profile_places(p.wheel, p.rail, strips.s, middles.point)
    return patch_rows(zones.weight, strips, tractions, middles.axes, places, v)


@dataclass(frozen=True, eq=False)
class SolvedWheels:
    """Wheels of one side, solved together.

    Parameters:
        parameters: of the pair.
        pairs: poses and motions.
        forces: with moments about the pairs' centres.
        mirror: whether the forces are those in the mirror y = 0.
    """

    parameters: Parameters
    pairs: WheelPairs
    forces: WheelForces
    mirror: bool

    @classmethod
    def at_pair(cls, parameters: Parameters, pose: Pose, motion: RigidMotion) -> SolvedWheels:
        """One wheel, with the moment about the rail's origin."""
        pairs = WheelPairs.of(pose, motion)
        return cls(parameters, pairs, wheel_forces(parameters, pairs, False), False)

    @classmethod
    def at_states(cls, parameters: Parameters, states: Array, dimensions: Dimensions, mirror: bool) -> SolvedWheels:
        """Wheels of one side; other parameters as for `forces_in_states`."""
        return cls(parameters, *forces_in_states(parameters, states, dimensions, mirror), mirror)

    def patches(self, i: int) -> tuple[Patch, ...]:
        """Patches of a wheel that touches its rail."""
        own = patches_of(wheel_patches(self.parameters, self.pairs, self.forces, i))
        return tuple(patch.mirrored() for patch in own) if self.mirror else own

    def tangent(self, i: int) -> ContactTangent:
        """Tangent of a result."""
        return ContactTangent(WheelDerivative(self, i), self.pairs.centre[i], self.mirror)

    def by_states(self, wheels: Nodes, states: Array, dimensions: Dimensions) -> Array:
        """Derivatives (m, 6, 9) by the coordinates of wheelsets; parameters as for `tangents_in_states`."""
        p, pairs, forces = self.parameters, self.pairs, self.forces
        return tangents_in_states(p, pairs, forces, wheels, states, dimensions, self.mirror)


@dataclass(frozen=True, eq=False)
class WheelDerivative:
    """Derivative of the force of a wheel on a rail.

    Parameters:
        of: wheels that were solved together.
        wheel: index.
    """

    of: SolvedWheels
    wheel: int

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        solved, wheels = self.of, np.array([self.wheel])
        return np.asarray(wheel_tangents(solved.parameters, solved.pairs, solved.forces, wheels)[0])


class WheelsTogether(NamedTuple):
    """Wheels that were solved together, and indices (m,) of some of them; -1: separated."""

    of: SolvedWheels
    indices: Nodes


def solved_together(results: Sequence[ContactResult]) -> WheelsTogether | None:
    """The wheels of results whose tangents one call computes; None if they were not solved together."""
    solved, indices = None, []
    for result in results:
        tangent = result.force_tangent
        of = tangent.of if isinstance(tangent, ContactTangent) else None
        if not isinstance(of, WheelDerivative) or (solved is not None and of.of is not solved):
            if result.status != "separated":
                return None
            indices.append(-1)
        else:
            solved = of.of
            indices.append(of.wheel)
    return None if solved is None else WheelsTogether(solved, np.array(indices))
