"""Force of a wheel on a rail with Piotrowski and Kik's pressures in one compiled call; its derivative and the patches
in one more each, on demand, from the interpenetration regions of the force.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions, WheelRegions, wheel_regions
from wheelrail.contact.geometry.rigid_search import Lines
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.geometry.wheel_surface import profile_places, wheel_points
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity
from wheelrail.contact.models.standard.force_derivatives import force_derivatives
from wheelrail.contact.models.standard.forces import StripFrames, StripFriction, strip_forces
from wheelrail.contact.models.standard.normal import StripPressures, virtual_penetration
from wheelrail.contact.models.standard.patches import patch_rows, patches_of
from wheelrail.contact.models.standard.pressure_derivatives import virtual_penetration_derivatives
from wheelrail.contact.models.standard.region_derivatives import region_derivatives
from wheelrail.contact.models.standard.strip_loads import strip_loads
from wheelrail.contact.results.result import Patch
from wheelrail.meshes.curves.closest_point import Shape
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


class WheelForce(NamedTuple):
    """Force of a wheel.

    Parameters:
        approach: m, largest penetration.
        beyond: whether the wheel overlaps the rail beyond the lines.
        contacts, points: numbers of contacts and of cells.
        force, moment: (3,) N and N m, about the rail's origin.
        along, across: m, largest semi-axes.
        speed: m/s, smallest rolling speed of a contact.
        found: regions.
    """

    approach: float
    beyond: bool
    contacts: int
    points: int
    force: Array
    moment: Array
    along: float
    across: float
    speed: float
    found: WheelRegions


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
    wheel: Shape, radius: float, origin: Array, rotation: Array, zones: PenetrationRegions, strips: StripPressures
) -> tuple[StripFrames, StripFrames]:
    """Frames on the wheel's surface in the middles of strips, and at the maxima of the penetration."""
    middles, axes = wheel_points(wheel, radius, origin, rotation, strips.s, strips.x)
    peaks, peak_axes = wheel_points(wheel, radius, origin, rotation, zones.peak, zones.peak_x)
    return StripFrames(middles, axes), StripFrames(peaks, peak_axes)


@compiled
def wheel_rail_force(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Lines,
    merge: float,
    v: RigidVelocities,
    elastic: PairElasticity,
    method: int,
    mu: float,
    reduction: tuple[float, float],
    cells: int,
) -> WheelForce:
    """Force and moment of a wheel.

    Parameters:
        wheel, rail, radius, origin, rotation, lines, merge: as for `wheel_regions`.
        v: rigid motion of wheel and rail.
        elastic: constants of both bodies.
        method: of the tangential problem, see `StripFriction`.
        mu: friction coefficient.
        reduction: factors of Polach's formula.
        cells: along each strip.
    """
    found = wheel_regions(wheel, rail, radius, origin, rotation, lines, merge)
    k, n, force, moment = len(found.contacts), len(found.contact) * cells, np.zeros(3), np.zeros(3)
    if k == 0:
        return WheelForce(found.approach, found.beyond, k, n, force, moment, 0.0, 0.0, 0.0, found)
    zones = penetration_regions(found)
    strips = virtual_penetration(zones, elastic.E_star)
    middles, peaks = strip_frames(wheel, radius, origin, rotation, zones, strips)
    speed = strip_loads(strips, zones, middles, peaks, v, elastic, (method, mu, reduction, cells), force, moment)
    along, across = strips.along.max(), strips.across.max()
    return WheelForce(found.approach, found.beyond, k, n, force, moment, along, across, speed, found)


@compiled
def wheel_rail_tangent(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Lines,
    merge: float,
    v: RigidVelocities,
    elastic: PairElasticity,
    mu: float,
    cells: int,
    found: WheelRegions,
) -> Array:
    """Derivative (6, 12) of force and moment about the rail's origin, with FASTSIM or without friction.

    Parameters as for `wheel_rail_force`; found: its regions, of bodies that touch.
    """
    zones = penetration_regions(found)
    strips = virtual_penetration(zones, elastic.E_star)
    by_zones = region_derivatives(wheel, rail, radius, origin, rotation, lines.s, merge, found)
    by_strips = virtual_penetration_derivatives(zones, strips, by_zones)
    frames = strip_frames(wheel, radius, origin, rotation, zones, strips)
    return force_derivatives(
        wheel, radius, (origin, rotation), zones, strips, frames, v, elastic, mu, cells, by_zones, by_strips
    )


@compiled
def wheel_rail_patches(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Lines,
    merge: float,
    v: RigidVelocities,
    elastic: PairElasticity,
    method: int,
    mu: float,
    reduction: tuple[float, float],
    cells: int,
    found: WheelRegions,
) -> Array:
    """Rows of all patches by decreasing load, see `wheelrail.contact.results.patch_sums.PatchSums.of`.

    Parameters as for `wheel_rail_force`; found: its regions, of bodies that touch.
    """
    zones = penetration_regions(found)
    strips = virtual_penetration(zones, elastic.E_star)
    middles, peaks = strip_frames(wheel, radius, origin, rotation, zones, strips)
    friction = StripFriction(method, np.full(len(strips.s) * cells, mu), np.full(len(zones.peak), mu), reduction)
    tractions = strip_forces(strips, zones.weight, middles, peaks, v, elastic, friction, cells)
    places = profile_places(wheel, rail, strips.s, middles.point)
    return patch_rows(zones.weight, strips, tractions, middles.axes, places, v)


@dataclass(frozen=True, eq=False)
class WheelOnRail:
    """A wheel at a pose and motion.

    Parameters:
        surfaces: wheel and rail.
        elastic: constants of both bodies.
        method: of the tangential problem, see `StripFriction`.
        mu: friction coefficient.
        reduction: factors of Polach's formula.
        cells: along each strip.
        pose, motion: of the wheel, and of both bodies.
    """

    surfaces: RigidWheelRail
    elastic: PairElasticity
    method: int
    mu: float
    reduction: tuple[float, float]
    cells: int
    pose: Pose
    motion: RigidMotion

    @property
    def geometry(self) -> tuple[Shape, Shape, float, Array, Array, Lines, float, RigidVelocities]:
        """First arguments of the compiled functions."""
        pair, pose = self.surfaces, self.pose
        rotation = np.ascontiguousarray(pose.rotation)
        velocities = RigidVelocities.of(self.motion)
        shapes = pair.wheel.shape, pair.rail.shape
        return (*shapes, pair.radius, pose.origin, rotation, pair.lines, pair.merge_distance, velocities)

    def force(self) -> WheelForce:
        """Force and moment."""
        friction = self.method, self.mu, self.reduction, self.cells
        return wheel_rail_force(*self.geometry, self.elastic, *friction)

    def patches(self, found: WheelRegions) -> tuple[Patch, ...]:
        """Patches on the regions of the force, where the bodies touch."""
        friction = self.method, self.mu, self.reduction, self.cells
        return patches_of(wheel_rail_patches(*self.geometry, self.elastic, *friction, found))


@dataclass(frozen=True, eq=False)
class ForceDerivative:
    """Derivative of the force of a wheel on a rail, where they touch.

    Parameters:
        at: pose and motion.
        found: regions of the force.
    """

    at: WheelOnRail
    found: WheelRegions

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        at = self.at
        return wheel_rail_tangent(*at.geometry, at.elastic, at.mu, at.cells, self.found)
