"""Kalker's creepage coefficients of the linear theory of rolling, elliptic contact of similar bodies.

Table E.3 of J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, 1990. C11, C22 and C23 as tabulated in
CONTACT (routine linrol, revision 2707, Apache-2.0) and in two other public programs; C33 for Poisson's ratio 1/4 only.
Interpolation: linear in min(a / b, b / a) and, as in CONTACT, a parabola of 1 / C in Poisson's ratio. The table is
rounded to three digits and, compared with CONTACT on fine grids, accurate to about 1 %.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from wheelrail.support.arrays import Array

Name = Literal["C11", "C22", "C23", "C33"]

RATIO = np.arange(1, 11) / 10  # short over long semi-axis
POISSON = np.array([0.0, 0.25, 0.5])

# rows Poisson's ratio, columns RATIO; first for a <= b (a along the rolling direction), then for a >= b
TABLE: dict[Name, Array] = {
    "C11": np.array(
        [
            [
                [2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.40],
                [3.31, 3.37, 3.44, 3.53, 3.62, 3.72, 3.81, 3.91, 4.01, 4.12],
                [4.85, 4.81, 4.80, 4.82, 4.83, 4.91, 4.97, 5.05, 5.12, 5.20],
            ],
            [
                [10.7, 6.96, 5.57, 4.84, 4.37, 4.06, 3.82, 3.65, 3.51, 3.40],
                [11.7, 7.78, 6.34, 5.57, 5.10, 4.78, 4.54, 4.36, 4.22, 4.12],
                [12.9, 8.82, 7.34, 6.57, 6.11, 5.80, 5.58, 5.42, 5.30, 5.20],
            ],
        ]
    ),
    "C22": np.array(
        [
            [
                [2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.40],
                [2.52, 2.63, 2.75, 2.88, 3.01, 3.14, 3.28, 3.41, 3.54, 3.67],
                [2.53, 2.66, 2.81, 2.98, 3.14, 3.31, 3.48, 3.65, 3.82, 3.98],
            ],
            [
                [10.7, 6.96, 5.57, 4.84, 4.37, 4.06, 3.82, 3.65, 3.51, 3.40],
                [12.8, 8.14, 6.40, 5.48, 4.90, 4.50, 4.21, 3.99, 3.81, 3.67],
                [16.0, 9.79, 7.51, 6.31, 5.56, 5.04, 4.67, 4.39, 4.16, 3.98],
            ],
        ]
    ),
    "C23": np.array(
        [
            [
                [0.334, 0.483, 0.607, 0.720, 0.827, 0.930, 1.03, 1.13, 1.23, 1.33],
                [0.473, 0.603, 0.715, 0.823, 0.929, 1.03, 1.14, 1.25, 1.36, 1.47],
                [0.731, 0.809, 0.889, 0.977, 1.07, 1.18, 1.29, 1.40, 1.51, 1.63],
            ],
            [
                [12.2, 5.72, 3.79, 2.88, 2.35, 2.01, 1.76, 1.58, 1.44, 1.33],
                [14.6, 6.63, 4.32, 3.24, 2.62, 2.23, 1.95, 1.75, 1.59, 1.47],
                [18.0, 7.89, 5.01, 3.70, 2.96, 2.50, 2.18, 1.94, 1.77, 1.63],
            ],
        ]
    ),
}
C33_AT_A_QUARTER = np.array(
    [
        [8.28, 4.27, 2.96, 2.32, 1.93, 1.68, 1.50, 1.37, 1.27, 1.19],
        [0.526, 0.601, 0.674, 0.747, 0.819, 0.892, 0.965, 1.04, 1.11, 1.19],
    ]
)


def kalker(name: Name, ratio: float, nu: float) -> float:
    """Creepage coefficient of an elliptic contact.

    Parameters:
        name: "C11", "C22", "C23" or "C33".
        ratio: a / b of the semi-axes, a along the rolling direction, 0.1 to 10.
        nu: Poisson's ratio, 0 to 0.5; 1/4 for C33.

    Raises ValueError for values outside these ranges.
    """
    if not (0.1 <= ratio <= 10.0 and 0.0 <= nu <= 0.5):
        raise ValueError(f"ratio = {ratio}, nu = {nu}: coefficients are tabulated for ratio 0.1 to 10 and nu 0 to 0.5")
    along, short = int(ratio > 1.0), min(ratio, 1.0 / ratio)
    if name == "C33":
        if nu != 0.25:
            raise ValueError(f"nu = {nu}: C33 is tabulated for nu = 0.25 only")
        return float(np.interp(short, RATIO, C33_AT_A_QUARTER[along]))
    tabulated = np.array([np.interp(short, RATIO, row) for row in TABLE[name][along]])
    weight = np.array([np.prod([(nu - q) / (p - q) for q in POISSON if q != p]) for p in POISSON])
    return float(1.0 / (weight @ (1.0 / tabulated)))
