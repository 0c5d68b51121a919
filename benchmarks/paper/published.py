"""Published values of the paper's Tables 5, 6 and 7 and Fig. 9, for comparison.

Magheri, Malvezzi, Meli, Rindi, "An innovative wheel-rail contact model for multibody applications", section 6.1: on an
Intel Xeon at 2.66 GHz with 8 GB, Matlab R2007b. Read from a scan; illegible values are None or mentioned in a note.
"""

from __future__ import annotations

from dataclasses import dataclass

SOURCE = "Magheri, Malvezzi, Meli, Rindi, section 6.1 (Xeon 2.66 GHz, Matlab R2007b), read from a scan"


@dataclass(frozen=True)
class Printed:
    """One half of a printed table: contact problems, total Newton iterations, linear iterations per Newton iteration,
    each (right, left), None where not printed; time s of the whole run.
    """

    name: str
    problems: tuple[int | None, int | None]
    newton: tuple[int, int]
    linear: tuple[float, float] | None
    seconds: float


CONDENSED_23 = Printed("Eq. (15), ODE23, BiCGStab", (27409, 31814), (8396, 29495), (2.9, 3.5), 2 * 3600 + 20 * 60)
TABLES: dict[str, tuple[Printed, ...]] = {
    "5": (
        Printed("Eq. (12), ODE23, BiCGStab", (31390, None), (31236, 32610), (4.3, 4.6), 8 * 3600 + 40 * 60),
        CONDENSED_23,
    ),
    "6": (
        Printed("Eq. (12), ODE45, BiCGStab", (49126, 38365), (48753, 51399), (5.6, 4.7), 13 * 3600 + 32 * 60),
        Printed("Eq. (15), ODE45, BiCGStab", (44625, None), (12870, 46170), (3.1, 3.5), 3 * 3600 + 34 * 60),
    ),
    "7": (
        Printed("Eq. (15), ODE23, LU", (23936, 30401), (39096, 24306), None, 10 * 3600 + 51 * 60),
        CONDENSED_23,
    ),
}
NOTES = (
    "The paper's columns: #cps contact problems, #New Newton iterations in all, #BiCGS linear iterations per Newton "
    "iteration, time; rows R and L for the right and left pair. It prints no RHS evaluations and no error.",
    "Not legible with certainty in the scan: #cps of the left pair of Eq. (12) in Table 5 (294.. or 9435) and of "
    "Eq. (15) in Table 6 (4571.. or 5710), left out here; that of Eq. (15) in Table 5 is taken from Table 7, where the "
    "same run is printed.",
    "Exponents of Table 4 (RelTol, AbsTol, Tol) are illegible in the scan; eta = 0.01, 20 Newton and 20 linear "
    "iterations at most are legible. Ours: RelTol and AbsTol of the scene.",
)
FIG_9 = (
    "Fig. 9 of the paper gives the time for eta = 0.5 and four powers of ten; its axis runs from about 8 000 to "
    "10 500 s and Table 7 has 2 h 20 min for eta = 0.01. The points are not legible in the scan."
)
