"""Contact with all nodal displacements, eq. (12), by number of unknowns: Newton and BiCGStab with several
preconditioners.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter

from benchmarks.common.hertz_cases import block_correction
from benchmarks.common.hertz_pairs import STEEL, creep_force, rolling
from benchmarks.common.measurement import Row, peak
from benchmarks.scaling.refined_body import PAIR, depth, pair
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full.model import FullContact
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.models.full.preconditioner import Preconditioner

CREEPAGE, FRICTION = 1e-3, 0.3
STIFF = 1e17  # N/m3: leaves 0.03 % of the approach
# the project's own, the paper's complete factor (by CHOLMOD, by MUMPS), an incomplete one, and multigrid
METHODS: dict[str, tuple[Preconditioner, str]] = {
    "corrected Cholesky": ("corrected", ""),
    "Cholesky, eq. (19)": ("cholesky", ""),
    "MUMPS": ("cholesky", "mumps"),
    "ICC": ("icc", ""),
    "GAMG": ("gamg", ""),
}


def newton(*, method: str, across: int, friction: bool) -> Iterator[Row]:
    """One contact: seconds of assembly, set-up of the preconditioner and solution, Newton and BiCGStab iterations, MB,
    errors of the load and of the creep force in % of Hertz and of CONTACT.

    Frictionless with a nearly exact law, with friction with the paper's laws.
    """
    preconditioner, package = METHODS[method]
    laws = ContactLaws.penalty(FRICTION) if friction else ContactLaws(STIFF, 0.0)
    model = pair(across, laws, FullOptions(preconditioner=preconditioner))
    start = perf_counter()
    stiffness = (model.wheel.stiffness, model.rail.stiffness)
    assembled = perf_counter()
    solver = model.solver
    _prepared(model, package)
    model.law  # noqa: B018 - compiled once
    ready = perf_counter()
    approach = PAIR.exact.approach - 2 * block_correction(STEEL.nu)[0] * PAIR.load / (STEEL.E * depth())
    result = model(hertz_pose(approach), rolling(CREEPAGE if friction else 0.0), None)
    solved = perf_counter()
    if result.status != "converged":
        raise RuntimeError(f"Error: {result.status}")
    row: Row = {
        "unknowns": sum(part.getSize()[0] for part in stiffness),
        "points": result.statistics.points,
        "assembly": assembled - start,
        "set-up": ready - assembled,
        "solve": solved - ready,
        "newton": result.statistics.newton,
        "linear": result.statistics.linear,
        "memory": peak(),
        "residual": result.statistics.residual,
        "force error": 100 * float(result.force[2] / PAIR.load - 1),
    }
    assert solver.count.failed_linear == 0
    if friction:
        row["creep error"] = 100 * float(-result.force[0] / creep_force(PAIR, CREEPAGE, FRICTION) - 1)
    yield row


def _prepared(model: FullContact, package: str) -> None:
    """Preconditioner set up before the solve, by another package if named."""
    pc = model.solver.krylov_solver.getPC()
    if package == "mumps":
        pc.setFactorSolverType(package)
    pc.setUp()
