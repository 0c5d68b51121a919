# ---
# jupyter:
#   jupytext:
#     formats: ipynb,py:percent
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Full, condensed and 2.5D models: equal solutions, different costs
#
# Three models of the same contact of two elastic bodies. With displacements $u$ of both meshes, tractions $t$ at the
# contact points and the matrix $B$ from displacements to penetrations and slips there:
#
# 1. **Full**: Newton's method for all unknowns, $K u = B^{\mathsf T} t(B u)$. It makes no further assumption, and every
#    step is a linear solve with all unknowns of both meshes.
# 2. **Condensed**: the bodies are linear; only the contact is nonlinear. One solve with $K$ for each surface node in
#    the contact region gives the compliance $C = B K^{-1} B^{\mathsf T}$; the remaining problem is $w = C\,t$ with the
#    contact laws, in some hundred unknowns. It is the *same* discrete problem, and $C$ is stored on disk for all loads
#    and positions.
# 3. **Condensed, 2.5D** (`bodies="waveguide"`): rail and block have a constant cross-section, so along $x$ the exact
#    solution is a sum of waves $\hat u(y, z)\,e^{\mathrm i k x}$. All waves use one mesh of the *cross-section*,
#
#    $$ \left(K_0 + \mathrm i k\,K_1 + k^2 K_2\right)\hat u = \hat t, $$
#
#    a small complex problem for each wavenumber $k$. There is no mesh length and no discretisation error along $x$, and
#    contact points can be at any $x$: **fitted cells** that end at the patch edge.

# %%
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import wheelrail as wr
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
FRICTIONS = (0.0, 0.3)  # for the comparison with the full model
SIZE = 1.6e-3  # m, surface size of this comparison: coarse, because of the full model
HALVED_SOLIDS = 1  # number of halvings of the size, condensed solids
HALVED_GRIDS = 3  # the same, regular grids on waveguides
FITTED = ((4, 6), (6, 8), (8, 12), (12, 16), (16, 24))  # strips and cells of fitted points
FINEST = (24, 32)

# %% [markdown]
# ## Equal solutions
#
# A sphere of 0.3 m radius on a flat block at the approach of Hertz under 10 kN; first frictionless, then rolling with a
# creepage of 1 per mille. Times are those of the first call, including meshes and compliances (or reading them from the
# cache), and of a second call.

# %%
RADII, FLAT, CREEPAGE = (0.3, 0.3), (np.inf, np.inf), (-1e-3, 0.0, 0.0)
exact = wr.Hertz(RADII, FLAT).closed_form(load=10e3)


def timed(friction, **options):
    """Solution, and times of the first and of a second call in s."""
    pair, times = wr.Hertz(RADII, FLAT, friction=friction, approach=exact.approach, **options), []
    for _ in range(2):
        start = perf_counter()
        solution = pair.solve(creepage=CREEPAGE if friction else None)
        times.append(perf_counter() - start)
    return solution, times


def row(solution, times):
    """Row of a table; unknowns are contact tractions, for the full model all displacements."""
    data = solution.data.sel(side="contact")
    start = solution.results["contact"].warm_start
    points = int((data.pressure > 0).sum())
    return {
        "first [s]": times[0],
        "second [s]": times[1],
        "loaded points": points,
        "unknowns": start.size if isinstance(start, np.ndarray) else points * (3 if data.traction.any() else 1),
        "normal force [N]": data.vertical_force.item(),
        "creep force [N]": data.longitudinal_force.item(),
    }


MODELS = {
    "full": {"model": "full", "surface_size": SIZE},
    "condensed": {"bodies": "solid", "surface_size": SIZE},
    "2.5D, grid": {"points": "grid", "surface_size": SIZE},
    "2.5D, fitted": {"surface_size": SIZE / 2},
}
solutions = {(name, mu): timed(mu, **options) for mu in FRICTIONS for name, options in MODELS.items()}
comparison = pd.DataFrame({key: row(*solution) for key, solution in solutions.items()}).T.rename_axis(
    ["model", "friction"]
)
print(comparison.to_string(float_format="{:.6g}".format))
for mu in FRICTIONS:
    full, condensed = (solutions[name, mu][0].data for name in ("full", "condensed"))
    difference = float(abs(full.pressure - condensed.pressure).max() / full.pressure.max())
    print(f"friction {mu:g}: pressures of full and condensed differ by {difference:.1e} of the peak")
    assert difference < 1e-8
    assert abs(full.vertical_force / condensed.vertical_force - 1).max() < 1e-8

# %% [markdown]
# The full and the condensed model agree to the tolerance of Newton's method: condensation is exact algebra. The third
# model has different elements (second degree, in the cross-section only) and agrees within the discretisation error of
# so few cells under the patch. The remaining question is the cost of a given error.

# %%
section_figure, ax = plt.subplots(figsize=(5.6, 3.8), layout="constrained")
line = np.linspace(-1, 1, 201) * exact.semi_axes[0]
ax.plot(1e3 * line, exact.pressure(line, 0 * line) / 1e6, color="0.4", lw=1.0, label="Hertz, half-spaces")
for name, mark, color in zip(MODELS, "s+o.", ("#0072B2", "0.1", "#009E73", "#D55E00"), strict=True):
    data = solutions[name, FRICTIONS[0]][0].data
    (x, y), pressure = data.position.values[:, :2].T, data.pressure.values
    middle = (y - y[y > -1e-9].min() < 1e-9) & (y > -1e-9) & (pressure > 0)  # the line next to y = 0
    ax.plot(1e3 * x[middle], pressure[middle] / 1e6, mark, color=color, mfc="none", ms=9, label=name)
ax.set(xlabel="x, forward [mm]", ylabel="pressure in the middle [MPa]", title=f"surface size {1e3 * SIZE:g} mm")
ax.legend()

# %% [markdown]
# ## Cost of a given error
#
# Errors of normal and creep force at the given approach in rolling, against the finest solution. Sizes are successively
# halved, so that all blocks have the same depth: at a given approach the depth alone changes the force by some tenths
# of a per cent (notebook 02). The time of the first call on solids grows with the number of surface nodes, each of
# which needs a solve with the whole mesh; the time of later calls depends on the number of contact points. The solids
# have elements of first degree, whose error is visible at these sizes. Fitted cells need a fraction of the points of a
# grid for the same error.

# %%
reference = row(*timed(0.3, surface_size=SIZE / 2, strips=FINEST[0], cells=FINEST[1]))
FORCES = ("normal force [N]", "creep force [N]")


def sizes(halved, **options):
    """Options of the size and of its successive halves."""
    return {f"{1e3 * size:g} mm": {**options, "surface_size": size} for size in SIZE * 0.5 ** np.arange(halved + 1)}


families = {
    "condensed solids": sizes(HALVED_SOLIDS, bodies="solid"),
    "2.5D, grid": sizes(HALVED_GRIDS, points="grid"),
    "2.5D, fitted": {f"{n} x {m}": {"surface_size": SIZE / 2, "strips": n, "cells": m} for n, m in FITTED},
}
costs = {
    name: pd.DataFrame({label: row(*timed(0.3, **options)) for label, options in variants.items()}).T
    for name, variants in families.items()
}
if 0.3 in FRICTIONS:
    costs = {"full": pd.DataFrame({f"{1e3 * SIZE:g} mm": row(*solutions["full", 0.3])}).T, **costs}
for table in costs.values():
    for force in FORCES:
        table[force.replace("[N]", "error [%]")] = 100 * abs(table[force] / reference[force] - 1)
print(pd.concat(costs).to_string(float_format="{:.5g}".format))

cost_figure, panels = plt.subplots(1, 2, figsize=(10, 4), layout="constrained", sharey=True)
for ax, force in zip(panels, FORCES, strict=True):
    error = force.replace("[N]", "error [%]")
    series = {name: (table["second [s]"], table[error]) for name, table in costs.items()}
    wr.plot_work_precision(series, xlabel="time of a solve with cached compliance [s]", ylabel="error [%]", ax=ax)
    ax.set_title(force.removesuffix(" [N]"))
fitted = costs["2.5D, fitted"]
assert fitted["normal force error [%]"].iloc[-1] < 0.3
assert fitted["normal force error [%]"].is_monotonic_decreasing
assert abs(costs["2.5D, grid"]["normal force error [%]"]).max() < 10

# %% [markdown]
# ## Choice of the model
#
# - **2.5D with fitted cells**, the default: rails, wheels (waves about the axle instead of along $x$) and all other
#   bodies with a constant cross-section. About ten milliseconds per solve, a few with warm starts, which is fast enough
#   for vehicle simulation.
# - **Condensed solids**, for bodies with a variable cross-section, or for the paper's model: seconds to minutes once
#   per mesh, then equally fast.
# - **Full**, for verification of the others, and for nonlinear bodies. It is the only model that is distributed by MPI.
# - **Regular grid**: for the paper's penalty law, to which cells are not fitted.
