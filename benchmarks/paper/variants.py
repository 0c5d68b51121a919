"""Variants of each table: contact model, integrator and options of Newton's method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from benchmarks.paper.segment import PaperBody
from wheelrail.vehicle.integration.integrate import METHODS

TOLERANCE = 1e-8  # relative residual of Newton's method in all runs but the references
ETAS = (0.5, 1e-1, 1e-2, 1e-3, 1e-4)
SOLID = PaperBody("solids 2 mm, paper's laws")
COARSE = PaperBody("solids 4 mm, paper's laws", (("surface_size", 4e-3),))
SOLID_EXACT = PaperBody("solids 2 mm, exact laws", (("laws", "exact"), ("bodies", "solid")))
WAVES = PaperBody("waveguides 2 mm on a grid, paper's laws", (("bodies", "waveguide"),))
WAVES_EXACT = PaperBody("waveguides 2 mm on a grid, exact laws", (("laws", "exact"), ("points", "grid")))
LATTICE = PaperBody("waveguides 2 mm, lattice, exact laws", (("laws", "exact"),))


@dataclass(frozen=True)
class PaperVariant:
    """One run. full: Eq. (12) instead of (15), on the short part; short: Eq. (15) on that part."""

    name: str
    body: PaperBody
    method: str
    options: tuple[tuple[str, Any], ...]
    full: bool = False
    short: bool = False

    @property
    def key(self) -> tuple[Any, ...]:
        """Key of a run: equal for identical runs."""
        return self.body, self.method, self.options, self.full, self.short


def krylov(eta: float = 0.01) -> tuple[tuple[str, Any], ...]:
    return (("forcing", eta), ("linear", "bicgstab"), ("tolerance", TOLERANCE))


LU: tuple[tuple[str, Any], ...] = (("tolerance", TOLERANCE),)


def sparse(jacobian: str = "exact") -> tuple[tuple[str, Any], ...]:
    return (("forcing", 0.01), ("jacobian", jacobian), ("tolerance", TOLERANCE))


def implicit() -> list[str]:
    """Integrators other than ODE23 and ODE45."""
    return [name for name in METHODS if name not in ("ode23", "ode45")]


def both_forms(method: str) -> list[PaperVariant]:
    """Rows of Tables 5 and 6."""
    name = method.upper()
    return [
        PaperVariant(f"Eq. (12), {name}, BiCGStab", COARSE, method, sparse(), full=True),
        PaperVariant(f"Eq. (15), {name}, BiCGStab", COARSE, method, krylov(), short=True),
        PaperVariant(f"Eq. (15), {name}, BiCGStab", SOLID, method, krylov()),
    ]


def additional_rows() -> list[PaperVariant]:
    """Rows that the paper does not have."""
    return [
        *(
            PaperVariant("Eq. (15), ODE23, LU", body, "ode23", LU)
            for body in (SOLID, SOLID_EXACT, WAVES, WAVES_EXACT, LATTICE)
        ),
        *(
            PaperVariant(f"Eq. (15), {method}, LU", body, method, LU)
            for method in implicit()
            for body in (SOLID, WAVES_EXACT, LATTICE)
        ),
        both_forms("ode23")[0],
        PaperVariant("Eq. (12), ODE23, product by differences (20)", COARSE, "ode23", sparse("difference"), full=True),
    ]


def table(name: str) -> list[PaperVariant]:
    """Rows of a table: "5", "6", "7", "9" for Fig. 9, or "new"."""
    if name in ("5", "6"):
        return both_forms({"5": "ode23", "6": "ode45"}[name])
    if name == "7":
        return [PaperVariant("Eq. (15), ODE23, LU", SOLID, "ode23", LU), both_forms("ode23")[-1]]
    if name == "9":
        return [PaperVariant(f"Eq. (15), ODE23, eta = {eta:g}", SOLID, "ode23", krylov(eta)) for eta in ETAS]
    if name == "new":
        return additional_rows()
    raise ValueError(f"no table {name}; there are 5, 6, 7, 9, new")
