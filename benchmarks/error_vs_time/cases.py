"""Contact models to compare, and their rolling contact cases."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np

from benchmarks.common.hertz_cases import block_correction
from benchmarks.common.models import EXACT, Ellipse, hertz_model, rolling, solved
from benchmarks.common.reference_table import reference
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_under_load
from wheelrail.contact.models.discretisation import Bodies, Model
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

LINES = 285  # points of a grid as fine as the lines under the strips


@dataclass(frozen=True)
class TimedCase:
    """A pair rolling with friction mu, creepages xi, eta and spin phi [rad/m]; (Fx, Fy) over mu F_n by CONTACT,
    extrapolated, None where they are not known.
    """

    pair: Ellipse
    friction: float
    creep: tuple[float, float, float]
    contact_forces: tuple[float, float] | None

    @property
    def bound(self) -> float:
        """mu F_n, N."""
        return self.friction * self.pair.load

    def forces(self, result: ContactResult) -> Array:
        """(Fx, Fy) over mu F_n."""
        return np.asarray(result.force[:2] / self.bound)

    def solved(self, model: ContactModel, depth: float) -> ContactResult:
        """At a depth [m]. Raises RuntimeError when it fails."""
        return solved(model, depth, rolling(*self.creep))


@cache
def timing_case() -> TimedCase:
    """The ellipse for which CONTACT's times are known; its forces from the two finest grids, first order in dx."""
    data = reference("timing")
    case, rows = data["case"], sorted(data["rows"], key=lambda row: float(row["dx"]))
    finest, second_finest = [row for row in rows if row["case"].endswith("rolling")][:2]
    factor = finest["dx"] / (second_finest["dx"] - finest["dx"])
    bound = case["mu"] * case["Fn"]
    fx, fy = ((finest[name] + factor * (finest[name] - second_finest[name])) / bound for name in ("Fx", "Fy"))
    pair = Ellipse.of_ratio(case["ratio"], 1e-3 * case["Rx"], case["Fn"], Material(1e6 * case["E"], case["nu"]))
    return TimedCase(pair, case["mu"], (case["xi"], case["eta"], 1e3 * case["phi"]), (fx, fy))


@cache
def creep_cases(every: int) -> tuple[TimedCase, ...]:
    """Every n-th of the 132 cases, from linear to saturated, at three ratios of the semi-axes."""
    cases = []
    for curve in reference("creep_curves")["curves"]:
        pair = Ellipse((curve["Rx"] * 1e-3, curve["Ry"] * 1e-3), curve["Fn"], Material(curve["E"] * 1e6, curve["nu"]))
        for _, xi, eta, phi, fx, fy, *_ in curve["cases"][::every]:
            cases.append(TimedCase(pair, curve["mu"], (xi, eta, 1e3 * phi), (fx, fy)))
    return tuple(cases)


@dataclass(frozen=True)
class ModelVariant:
    """A contact model: strips and cells of a lattice, or a regular grid with a number of points in the
    ellipse, on bodies.

    order of the slip formula; stiffness K [N/m3] and regularisation eps of the laws; warm: initial guess from a pose
    one step away.
    """

    family: str
    bodies: Bodies
    fineness: LatticeResolution | None = None
    points: int = LINES
    order: int = 2
    stiffness: float = EXACT
    regularisation: float = 0.0
    model: Model = "condensed"
    warm: bool = False

    @property
    def division(self) -> str:
        """Discretisation of the patch."""
        return f"{self.fineness.strips} x {self.fineness.cells}" if self.fineness else f"grid of {self.points}"

    @property
    def laws(self) -> str:
        """Short name of the laws."""
        normal = "exact" if np.isinf(self.stiffness) else f"K {self.stiffness:.0e}"
        return normal + (f", eps {self.regularisation:.0e}" if self.regularisation else "")

    def of(self, pair: Ellipse, friction: float) -> ContactModel:
        """Contact model of a pair."""
        laws = ContactLaws(self.stiffness, friction, self.regularisation if friction else 0.0)
        if self.fineness is None:
            return _model(pair, laws, replace(self, family="", regularisation=0.0))
        model = _model(pair, ContactLaws(), replace(self, family="", fineness=LatticeResolution(), warm=False))
        assert isinstance(model, LatticeContact)
        return replace(model, laws=laws, resolution=self.fineness)

    def hertz_depth(self, pair: Ellipse) -> float:
        """Hertz's approach [m] on these bodies, corrected for finite blocks."""
        if self.bodies == "half-space":
            return pair.exact.approach
        width = pair.half_width(pair.size(points=self.points))
        return pair.exact.approach - 2 * block_correction(pair.steel.nu)[0] * pair.load / (pair.steel.E * width)

    def loaded_depth(self, pair: Ellipse) -> float:
        """Depth [m] at which the pair carries its load without friction."""
        return _loaded(replace(self, family="", warm=False, order=2, regularisation=0.0, model="condensed"), pair)


@cache
def _loaded(variant: ModelVariant, pair: Ellipse) -> float:
    expected = variant.hertz_depth(pair) + pair.exact.peak / variant.stiffness
    return hertz_under_load(variant.of(pair, 0.0), rolling(0.0), pair.load, expected=expected, rtol=1e-7).depth


@lru_cache(maxsize=8)  # with friction and without, of all pairs: finenesses share them, and grids are large
def _model(pair: Ellipse, laws: ContactLaws, variant: ModelVariant) -> ContactModel:
    """Model of a pair; resolutions share meshes, spectra and tables."""
    choices: dict[str, Any] = {} if variant.bodies == "solid" else {"points": "lattice" if variant.fineness else "grid"}
    return hertz_model(
        pair,
        laws,
        pair.size(points=variant.points),
        model=variant.model,
        bodies=variant.bodies,
        slip_order=variant.order,
        **choices,
    )
