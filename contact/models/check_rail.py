"""Contact of a flange's back with a check rail or the wall of a groove, as that of a left-hand pair.

The back of a flange is a plane disc with a rounded edge, the check rail a vertical face with a rounded upper edge that
follows the curve of the track. Chords of the disc in the face are 0.2 to 0.3 m long: contacts lie at their ends, ahead
of the wheel's axle and behind it, where the edge of the disc leaves the face over its upper edge. With the centre c(t)
of the disc's edge at an angle t, its height d over the face, the face's normal n there, and the curvature k of the
track,

    n c'(t) = 0,    penetration = r - d > 0,    y_face(x) = y + k x^2 / 2.

The normal force is that of Hertz for the principal relative curvatures there, in series with the spring of the check
rail; friction is that of the rigid slip at the point, which is nearly all of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, sqrt
from typing import Any

import numpy as np

from wheelrail.contact.analytical.point_contact import point_contact
from wheelrail.contact.geometry.flange_back import CheckRail, FlangeBack
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side
from wheelrail.contact.kinematics.varied_pair import STEP, VariedPair, cross, dot, unit
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array

WIDEST = 0.7  # sine of the angle along the edge to which contacts are searched
ANGLES = np.linspace(-np.arcsin(WIDEST), np.arcsin(WIDEST), 91)
ROOM = 5e-4  # m, more than the neglected squares of yaw and roll
NEAR = 0.02  # of the edge's radius, above the check rail
CLOSE = 1e-9  # rad, last change of an angle by Newton's method, before the last steps
LAST = 4  # of these steps for derivatives; the slope errs by 1e-4, of a real angle one suffices
CREEP = 0.01  # m/s, slip at which friction has 0.7 of its coefficient
FLATTEST = 0.01  # 1/m, smallest relative curvature
LARGEST = 0.3  # semi-axis over the radius of an edge
UNKNOWN = np.nan


@dataclass(frozen=True, eq=False)
class _Touch:
    """Contact at one place, of n configurations: vectors (3, n), numbers (n,)."""

    point: Array
    normal: Array
    along: Array  # of the rail
    normal_force: Array
    friction: Array
    slip: Array
    semi_axes: tuple[Array, Array]
    pressure: Array
    sine: Array  # of the angle between the wheel's normal and its plane back

    @property
    def wrench(self) -> Array:
        """Force N and moment N m (6, n) about the rail's origin."""
        force = self.normal_force * self.normal + self.friction
        return np.concatenate([force, cross(self.point, force)])


@dataclass(frozen=True)
class CheckRailContact:
    """Contact model of a flange's back: pose and velocities in, `ContactResult` out. The guess is not used.

    Parameters:
        back: of the flange.
        rail: check rail.
        radius: of the rolling circle, m.
        modulus: E*, Pa, of both bodies.
        friction: coefficient.
    """

    back: FlangeBack
    rail: CheckRail
    radius: float
    modulus: float
    friction: float

    def rubbing(self, factor: float) -> CheckRailContact:
        """The model with its coefficient of friction times a factor."""
        return replace(self, friction=factor * self.friction)

    def clears(self, mounting: Mounting, state: WheelsetState, side: Side) -> bool:
        """Whether the check rail of a side is too far for any contact, by a quick bound for rigid axles and rails.

        Parameters:
            mounting: of the side.
            state: of the wheelset.
            side: of the check rail.
        """
        hand, k = (1.0 if side == "left" else -1.0), abs(state.frame_rate[2] / state.speed) if state.speed else 0.0
        k = k / (1.0 - k * mounting.rail_y)  # of the inner rail
        y = state.y if state.rail_shift is None else state.y - state.rail_shift[0 if side == "left" else 1][0]
        gap = hand * y + mounting.wheel_y + self.back.y - mounting.rail_y - self.rail.y
        reach = WIDEST * self._edge + mounting.wheel_y * abs(state.yaw)
        return gap > reach * (abs(state.yaw) + 0.5 * k * reach) + self._edge * abs(state.roll) + ROOM

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        gap = self._least_gap(pose)
        if gap > 0.0:
            return ContactResult.separated(-gap)
        at = VariedPair.of(pose, motion)
        angles, deepest = self._deepest(at)
        if not angles:
            return ContactResult.separated(deepest)
        if self._section(at, self._circle(at, np.array(angles))[0])[3].any():
            return ContactResult.failed("the flange is on top of the check rail", deepest)
        touches = [self._touch(at, angle) for angle in angles]
        if any(own.semi_axes[1] > LARGEST * min(self.back.rounding, self.rail.rounding) for own in touches):
            return ContactResult.failed("too deep in the check rail: the patch is as wide as its edge", deepest)
        force, moment = sum(own.wrench[:, 0] for own in touches).reshape(2, 3)  # type: ignore[union-attr]
        tangent = ContactTangent(_Derivative(self, pose, motion, tuple(angles)))
        speed = float(np.linalg.norm(motion.rail.velocity))
        patches = tuple(self._patch(own, speed) for own in touches)
        return ContactResult(
            force, moment, patches, approach=deepest, status="converged", force_tangent=tangent, fields=None
        )

    @property
    def _edge(self) -> float:
        """Radius m of the circle of centres of the edge's rounding."""
        return self.radius + self.back.height

    def _least_gap(self, pose: Pose) -> float:
        """A bound m below the distance of both bodies."""
        (forth, axle, up), k = pose.rotation[1].tolist(), pose.plan
        _, y, z = pose.origin.tolist()
        # of the circle, points count that are lower than the top of the check rail
        cosine = (z - abs(self.back.y * float(pose.rotation[2, 1])) - self.rail.height) / self._edge - NEAR
        sine = min(sqrt(max(1.0 - cosine * cosine, 0.0)), WIDEST)
        least = float(y + axle * (self.back.y + self.back.rounding) - self._edge * (sine * abs(forth) + abs(up)))
        bend = 0.5 * max(k, 0.0) * (self._edge * sine + abs(self.back.y)) ** 2
        return least - bend - self.back.rounding - self.rail.y

    def _deepest(self, at: VariedPair) -> tuple[list[float], float]:
        """Angles of the places where the edge is deepest, and the largest depth m."""
        rise, depth, _ = self._residual(at, ANGLES)
        deepest, found = float(depth.max()), list[float]()
        for i in np.flatnonzero((rise[:-1] <= 0.0) & (rise[1:] > 0.0)):
            low, high = float(ANGLES[i]), float(ANGLES[i + 1])
            angle = low - (high - low) * float(rise[i] / (rise[i + 1] - rise[i]))
            for _ in range(60):  # Newton's method within bounds
                value, own, slope = (float(part[0]) for part in self._residual(at, np.array([angle])))
                low, high = (low, angle) if value > 0.0 else (angle, high)
                step = angle - value / slope if slope > 0.0 else inf
                step = step if low <= step <= high else 0.5 * (low + high)
                change, angle = abs(step - angle), step
                if change < CLOSE:
                    break
            deepest = max(deepest, own)
            if own > 0.0:
                found.append(angle)
        return found, deepest

    def _circle(self, at: VariedPair, angle: Array) -> tuple[Array, Array, Array]:
        """Points (3, n) m of the edge's circle at angles, and their first and second derivatives by the angle."""
        sine, cosine = np.sin(angle), np.cos(angle)
        out = self._edge * (sine * at.forth - cosine * at.up)
        centre = at.origin + (self.back.y + self.back.rounding) * at.axle
        return centre + out, self._edge * (cosine * at.forth + sine * at.up), -out

    def _section(self, at: VariedPair, c: Array) -> tuple[Array, Array, Array, Any]:
        """Distances m of points (3, n) from the rail's section, normals (2, n), curvatures 1/m of parallel curves,
        and which points are above the top.
        """
        y = c[1] - 0.5 * at.curvature * c[0] * c[0] - (self.rail.y - self.rail.rounding)
        z = c[2] - (self.rail.height - self.rail.rounding)
        on_edge = z.real > 0.0
        on_top = on_edge & (y.real <= 0.0)
        y = np.where(on_top, 0.0, y)
        length = np.where(on_edge, np.sqrt(np.where(on_edge, y * y + z * z, 1.0)), y)
        normal = np.where(on_edge, np.array([y, z]) / length, np.array([[1.0], [0.0]]))
        return length - self.rail.rounding, normal, np.where(on_edge, 1.0 / length, 0.0), on_top

    def _residual(self, at: VariedPair, angle: Array) -> tuple[Array, Array, Array]:
        """Slope m of the distance along the circle at angles (n,), zero at a contact, penetration m, and derivative of
        the slope by the angle.
        """
        c, forward, inward = self._circle(at, angle)
        distance, (ny, nz), bend, _ = self._section(at, c)
        k = at.curvature
        tilt = -k * c[0] * ny
        size = np.sqrt(1.0 + tilt * tilt)
        across = forward[1] - k * c[0] * forward[0]
        turn = bend * (nz * across - ny * forward[2])  # of the normal along the circle, from z to y
        slope = turn * (nz * across - ny * forward[2]) - k * ny * forward[0] * forward[0]
        slope = slope + tilt * inward[0] + ny * inward[1] + nz * inward[2]
        value = tilt * forward[0] + ny * forward[1] + nz * forward[2]
        return value / size, self.back.rounding - distance / size, slope / size

    def _touch(self, at: VariedPair, angle: float) -> _Touch:
        """Contact near an angle."""
        angles = np.full(at.origin.shape[1], angle, dtype=at.origin.dtype)
        for _ in range(LAST if np.iscomplexobj(angles) else 1):
            value, _, slope = self._residual(at, angles)
            angles = angles - value / slope
        _, depth, _ = self._residual(at, angles)
        c, forward, inward = self._circle(at, angles)
        _, (ny, nz), bend, _ = self._section(at, c)
        tilt = at.curvature * c[0]
        normal = unit(np.array([-tilt * ny, ny, nz]))
        along = unit(np.array([np.ones_like(tilt), tilt, np.zeros_like(tilt)]))
        sine = dot(normal, inward) / self._edge
        edge = np.where(bend != 0.0, 1.0 / self.rail.rounding, 0.0)
        low, high = self._curvatures(-at.curvature * ny, edge, sine, normal, along, unit(forward))
        spring = self.rail.stiffness
        force, (a, b, pressure) = point_contact(depth, low, high, modulus=self.modulus, stiffness=spring)
        point = c - (self.back.rounding - 0.5 * depth) * normal
        slip = at.slip(point)
        slip = slip - dot(slip, normal) * normal
        friction = -self.friction * force * slip / np.sqrt(dot(slip, slip) + CREEP * CREEP)
        return _Touch(point, normal, along, force, friction, slip, (a, b), pressure, sine)

    def _curvatures(
        self, curve: Array, edge: Array, sine: Array, normal: Array, along: Array, forward: Array
    ) -> tuple[Array, Array]:
        """Principal relative curvatures (n,) 1/m, the smaller one first.

        Parameters:
            curve, edge: (n,) 1/m, curvature of the rail along the track and across.
            sine: of the angle between the wheel's normal and its plane back.
            normal, along, forward: (3, n), of the rail, its direction, and that of the wheel's edge.
        """
        r, across = self.back.rounding, cross(normal, along)
        xs, ys = dot(along, forward), dot(across, forward)  # of the wheel's edge in the rail's axes
        sideways = cross(normal, forward)
        xa, ya = dot(along, sideways), dot(across, sideways)
        xx = sine / (self._edge + r * sine) + curve * xs * xs + edge * ys * ys
        yy = 1.0 / r + curve * xa * xa + edge * ya * ya
        xy = curve * xs * xa + edge * ys * ya
        mean, half = 0.5 * (xx + yy), np.sqrt((0.5 * (xx - yy)) ** 2 + xy * xy)
        low = mean - half
        return np.where(low.real > FLATTEST, low, FLATTEST), mean + half

    def _patch(self, own: _Touch, speed: float) -> Patch:
        """Patch of a contact at a rolling speed, m/s."""
        normal, along, slip, friction = (part[:, 0] for part in (own.normal, own.along, own.slip, own.friction))
        across, (x, y, _) = np.cross(normal, along), own.point[:, 0].tolist()
        place = self.back.y + self.back.rounding * (1.0 - sqrt(1.0 - float(own.sine[0]) ** 2))
        a, b = (float(axis[0]) for axis in own.semi_axes)
        creep = (float(slip @ along) / speed, float(slip @ across) / speed, 0.0) if speed else (0.0, 0.0, 0.0)
        return Patch(
            area=np.pi * a * b,
            max_pressure=float(own.pressure[0]),
            normal_force=float(own.normal_force[0]),
            force=own.wrench[:3, 0],
            tangential_force=(float(friction @ along), float(friction @ across)),
            semi_axes=(a, b),
            contact_angle=float(np.arctan2(-normal[1], normal[2])),
            wheel_s=UNKNOWN,
            rail_s=UNKNOWN,
            wheel_y=place,
            rail_y=y,
            wheel_band=(place, place),
            rail_band=(y, y),
            x=x,
            stick_area=0.0,
            creepage=creep,
            frictional_power=float(-friction @ slip),
        )


@dataclass(frozen=True, eq=False)
class _Derivative:
    """Derivative of force and moment, computed on demand.

    Parameters:
        model: contact model.
        pose, motion: of the pair.
        angles: of the contacts.
    """

    model: CheckRailContact
    pose: Pose
    motion: RigidMotion
    angles: tuple[float, ...]

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin, by complex steps."""
        at = VariedPair.of(self.pose, self.motion, changes=True)
        return np.asarray(sum(self.model._touch(at, angle).wrench.imag for angle in self.angles) / STEP)
