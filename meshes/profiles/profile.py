"""Wheel and rail profiles: a curve in its body's frame, and the standard ones by name."""

from __future__ import annotations

import cmath
import hashlib
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from wheelrail.meshes.curves.arc_length import CurveSegment, curve
from wheelrail.meshes.curves.curve import Curve
from wheelrail.meshes.profiles.measurement import Measurement
from wheelrail.meshes.profiles.measures import RailMeasures, WheelMeasures, rail_measures, wheel_measures
from wheelrail.meshes.profiles.worn import worn
from wheelrail.support.arrays import Array
from wheelrail.support.cache import digest

Kind = Literal["wheel", "rail"]


KINDS: tuple[Kind, Kind] = ("wheel", "rail")
LEVEL, FLAT = 1e-7, 5e-3  # m, differences of height and width of a flat top; crowns of 30 m have less width


@dataclass(frozen=True)
class Placement:
    """Rigid motion from the rail's axis frame (origin at the crown of the new rail) to the profile's frame.

    Rotation by angle [rad, from y to z] about the origin, then translation by shift (y, z) [m].
    """

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)

    def __call__(self, points: ArrayLike) -> Array:
        """Points (..., 2) m of the axis frame, in the profile's frame."""
        p = np.asarray(points, dtype=float)
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.asarray(p @ np.array([[c, s], [-s, c]]) + self.shift)

    def then(self, angle: float, shift: complex) -> Placement:
        """This motion followed by another."""
        total = cmath.exp(1j * angle) * complex(*self.shift) + shift
        return Placement(self.angle + angle, (total.real, total.imag))


@dataclass(frozen=True, eq=False)
class Profile(Curve):
    """Running surface of a wheel or of an inclined rail, points (y, z) in m, by arc length s [m].

    y is lateral, positive to the field side, and s grows with it; the body lies below the curve. Curvature is positive
    where the surface is convex. Wheel: from the flange's back; z is the height above the rolling circle, outward from
    the axle; s = 0 and z = 0 on the rolling circle, y = 0. Rail: z up; s = 0 at the origin, which is the highest point
    of the inclined rail. placement: rigid motion from the rail's axis frame, in which web and foot are defined, to this
    one. measurement: of a profile from a file, its noise and remarks on reading it. new: name of a worn profile when it
    was new.
    """

    name: str
    kind: Kind
    placement: Placement = Placement()
    measurement: Measurement | None = None
    new: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.kind not in KINDS:
            raise ValueError(f"kind of profile {self.name} is {self.kind!r}, allowed: {', '.join(KINDS)}")
        start, stop = self.s_range
        if not start < 0.0 < stop:
            raise ValueError(
                f"profile {self.name} must have its reference point s = 0 inside {start:.4g} .. {stop:.4g} m"
            )

    def __repr__(self) -> str:
        (y0, z0), (y1, z1) = self._reach
        return (
            f"Profile {self.name} ({self.kind}): y {1e3 * y0:.2f} to {1e3 * y1:.2f} mm, "
            f"z {1e3 * z0:.2f} to {1e3 * z1:.2f} mm, {1e3 * np.ptp(self.breaks):.2f} mm long"
        )

    @property
    def _reach(self) -> tuple[Array, Array]:
        """Least and largest y and z, m."""
        points = self.point(self.samples(1e-4))
        return points.min(axis=0), points.max(axis=0)

    def digest(self) -> str:
        """Hash of curve, kind and placement, without the name."""
        return hashlib.sha256(
            f"{super().digest()} {self.kind} {digest(placement=vars(self.placement))}".encode()
        ).hexdigest()

    def inclined(self, angle: float) -> Profile:
        """Rail inclined by an angle rad, top towards the track's centre, origin at the new highest point."""
        if self.kind != "rail":
            raise ValueError(f"only rails are inclined, {self.name} is a wheel")
        if angle == 0.0:
            return self
        s = self.highest(angle)
        shift = -cmath.exp(1j * angle) * complex(*self.point(s))
        rotated = self.transformed(angle, shift, -s)
        return replace(rotated, placement=self.placement.then(angle, shift))

    def worn(self, s: ArrayLike, removed_area: ArrayLike, name: str = "") -> Profile:
        """This profile without the material of cells of its arc length, in the same frame.

        Parameters:
            s: (n + 1,) m, bounds of equal cells, as of `wheelrail.meshes.profiles.worn.cell_bounds`.
            removed_area: (n,) m2 of the section, of each cell, not negative.
            name: of the worn profile; by default this one's, worn.

        Raises ValueError, as `wheelrail.meshes.profiles.worn.worn`.
        """
        new = self.new or self.name
        return replace(worn(self, s, removed_area), name=name or f"{new}, worn", new=new)

    def measures(
        self, new: Profile | None = None, *, radius: float = 0.46, flange_back: float = -0.070
    ) -> WheelMeasures | RailMeasures:
        """Measures of wear: Sh, Sd, qR and hollow of a wheel, W1 and W3 of a rail, and the removed section.

        Parameters:
            new: new profile in the same frame; a rail needs one.
            radius: of the rolling circle of the new wheel, m.
            flange_back: y of the flange's back of a wheel, m.

        A profile from a file has its own origin, on its own rolling circle or top: a remark says so. Raises ValueError.
        """
        if new is not None and new.kind != self.kind:
            raise ValueError(f"new must be a {self.kind}, {new.name} is a {new.kind}")
        found: WheelMeasures | RailMeasures
        if self.kind == "wheel":
            found = wheel_measures(self, new, radius=radius, flange_back=flange_back)
        elif new is None:
            raise ValueError(f"new is missing: wear of the rail {self.name} is measured against a new profile")
        else:
            crown = new.placement((0.0, 0.0))
            found = rail_measures(self, new, (crown, new.placement((0.0, 1.0)) - crown))
        if new is not None and self.measurement is not None and self.measurement is not new.measurement:
            names = "W1, W3" if self.kind == "rail" else "rolling radius"
            remark = f"{names} and removed section are relative: a file has its own origin"
            found = replace(found, remarks=(*found.remarks, remark))
        return found

    def gauge_offset(self, gauge: float, height: float) -> float:
        """Lateral position [m] of the rail's origin from the track's centre that gives the gauge [m].

        The gauge is measured at the innermost point of the rail no deeper than height [m] below its highest point.
        ValueError if the profile does not reach that deep on the gauge side.
        """
        if self.kind != "rail":
            raise ValueError(f"gauge is measured on rails, {self.name} is a wheel")
        s = self.samples(1e-4, stop=0.0)
        z = self.point(s)[:, 1]
        below = np.flatnonzero(z <= -height)
        if not len(below):
            field = self.point(self.samples(1e-4, start=0.0))[:, 1]
            hint = "; its field side does: is it mirrored?" if field.min() <= -height else ""
            raise ValueError(
                f"rail {self.name} reaches {-z.min():.4g} m below its top on the gauge side, not {height} m{hint}"
            )
        from scipy.optimize import brentq

        edge = brentq(lambda x: self.point(x)[1] + height, s[below[-1]], s[below[-1] + 1], xtol=1e-16)
        innermost = min(self.point(edge)[0], self.point(s[s > edge])[:, 0].min())
        return float(0.5 * gauge - innermost)

    def highest(self, angle: float = 0.0) -> float:
        """Arc length [m] of the highest point, once rotated by angle [rad]; of a flat top its middle."""
        from scipy.optimize import brentq

        def rise(x: float) -> float:
            t = self.tangent(x)
            return float(np.sin(angle) * t[0] + np.cos(angle) * t[1])

        s = self.samples(1e-4)
        z = self.point(s) @ [np.sin(angle), np.cos(angle)]
        level = np.append(z > z.max() - LEVEL, False)
        first = int(np.argmax(level))  # of equal humps the one on the gauge side
        last = first + int(np.argmin(level[first:])) - 1
        if s[last] - s[first] > FLAT and first > 0 and last < len(s) - 1:  # its highest point is noise
            return float(0.5 * (s[first] + s[last]))
        i = first + int(np.argmax(z[first : last + 1]))
        low, high = s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)]
        if not rise(low) >= 0.0 >= rise(high) or rise(low) == rise(high):
            return float(s[i])
        return float(brentq(rise, low, high, xtol=1e-17))


def from_sections(
    sections: list[CurveSegment], *, name: str, kind: Kind, placement: Placement | None = None
) -> Profile:
    """Profile from sections in its own frame, which must pass through the origin: s = 0 there."""
    whole = curve(sections)
    centred = Profile(whole.breaks - 0.5 * whole.breaks[-1], whole.coefficients, name, kind, placement or Placement())
    try:
        origin = float(centred.s_at_y(0.0))
    except ValueError:  # on a wall, as of a groove
        origin = float(centred.closest(np.zeros((1, 2))).s[0])
    return centred.transformed(0.0, 0.0, -origin)
