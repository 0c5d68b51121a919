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
# # Full, condensed and 2.5D: the same answer, the cost of each
#
# Three ways to the same contact of two elastic bodies. With displacements $u$ of both meshes, tractions $t$ of the
# contact points and the matrix $B$ that takes displacements to gaps and slips there:
#
# 1. **Full**: Newton's method for everything at once, $K u = B^{\mathsf T} t(B u)$. Nothing is assumed, and every
#    step solves with all unknowns of both meshes.
# 2. **Condensed**: bodies are linear; only the contact is not. So solve with $K$ once for each surface node in reach
#    and keep the compliance $C = B K^{-1} B^{\mathsf T}$: what is left is $w = C\,t$ with the laws of contact, in some
#    hundred unknowns. It is the *same* discrete problem, and $C$ is kept on disk for all loads and positions.
# 3. **Condensed, 2.5D** (`bodies="waveguide"`): rail and block are the same in every section, so along $x$ the exact
#    solution is a sum of waves $\hat u(y, z)\,e^{\mathrm i k x}$. One mesh of the *section* serves all of them,
#
#    $$ \left(K_0 + \mathrm i k\,K_1 + k^2 K_2\right)\hat u = \hat t, $$
#
#    a small complex problem for each wavenumber $k$. There is no length of mesh to choose and no error along $x$, and
#    contact points may lie anywhere along it: **fitted cells** that end where the contact ends.

# %%
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import wheelrail as wr
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
FRICTIONS = (0.0, 0.3)  # of the comparison with the full model
SIZE = 1.6e-3  # m, edge of the surface cells there: coarse, for the full model's sake
HALVED_SOLIDS = 1  # times that the size is halved, of the condensed solids
HALVED_GRIDS = 3  # and of the waveguides' regular grids
FITTED = ((4, 6), (6, 8), (8, 12), (12, 16), (16, 24))  # strips and cells of fitted ones
FINEST = (24, 32)

# %% [markdown]
# ## The same answer
#
# A ball of 0.3 m on a flat block at a given approach, that of Hertz under 10 kN; without friction, then rolling with a
# creepage of 1 per mille. Times are of the first call, with meshes and compliances (or their reading from the cache),
# and of a second one.

# %%
RADII, FLAT, CREEPAGE = (0.3, 0.3), (np.inf, np.inf), (-1e-3, 0.0, 0.0)
exact = wr.Hertz(RADII, FLAT).closed_form(load=10e3)


def clocked(friction, **options):
    """The solution, and seconds of the first and of a second call."""
    pair, times = wr.Hertz(RADII, FLAT, friction=friction, approach=exact.approach, **options), []
    for _ in range(2):
        start = perf_counter()
        solution = pair.solve(creepage=CREEPAGE if friction else None)
        times.append(perf_counter() - start)
    return solution, times


def row(solution, times):
    """What a table says of it; contact unknowns are tractions, those of the full model all displacements."""
    own = solution.data.sel(side="contact")
    moved = solution.results["contact"].warm_start
    points = int((own.pressure > 0).sum())
    return {
        "first [s]": times[0],
        "again [s]": times[1],
        "loaded points": points,
        "unknowns": points * (3 if own.traction.any() else 1) if not isinstance(moved, np.ndarray) else moved.size,
        "normal force [N]": own.vertical_force.item(),
        "creep force [N]": own.longitudinal_force.item(),
    }


WAYS = {
    "full": {"model": "full", "surface_size": SIZE},
    "condensed": {"bodies": "solid", "surface_size": SIZE},
    "2.5D, grid": {"points": "grid", "surface_size": SIZE},
    "2.5D, fitted": {"surface_size": SIZE / 2},
}
found = {(name, mu): clocked(mu, **options) for mu in FRICTIONS for name, options in WAYS.items()}
same = pd.DataFrame({key: row(*one) for key, one in found.items()}).T.rename_axis(["model", "friction"])
print(same.to_string(float_format="{:.6g}".format))
for mu in FRICTIONS:
    full, condensed = (found[name, mu][0].data for name in ("full", "condensed"))
    apart = float(abs(full.pressure - condensed.pressure).max() / full.pressure.max())
    print(f"friction {mu:g}: pressures of full and condensed differ by {apart:.1e} of the peak")
    assert apart < 1e-8
    assert abs(full.vertical_force / condensed.vertical_force - 1).max() < 1e-8

# %% [markdown]
# Full and condensed agree to the tolerance of Newton's method: condensing is algebra, no approximation. The third way
# has other elements (of second degree, in the section alone) and agrees as well as a mesh with so few cells under the
# patch can. So the question is only what a given error costs.

# %%
section_figure, ax = plt.subplots(figsize=(5.6, 3.8), layout="constrained")
line = np.linspace(-1, 1, 201) * exact.semi_axes[0]
ax.plot(1e3 * line, exact.pressure(line, 0 * line) / 1e6, color="0.4", lw=1.0, label="Hertz, half-spaces")
for name, mark, color in zip(WAYS, "s+o.", ("#0072B2", "0.1", "#009E73", "#D55E00"), strict=True):
    own = found[name, FRICTIONS[0]][0].data
    (x, off), pressure = own.position.values[:, :2].T, own.pressure.values
    middle = (off - off[off > -1e-9].min() < 1e-9) & (off > -1e-9) & (pressure > 0)  # the line next to y = 0
    ax.plot(1e3 * x[middle], pressure[middle] / 1e6, mark, color=color, mfc="none", ms=9, label=name)
ax.set(xlabel="x, forward [mm]", ylabel="pressure in the middle [MPa]", title=f"surface size {1e3 * SIZE:g} mm")
ax.legend()

# %% [markdown]
# ## What an error costs
#
# Errors of normal and creep force at the given approach, rolling, beside the finest solution at hand. Sizes are halves
# of one another, for then all blocks are equally deep: at a given approach that alone makes some tenths of a per cent
# (notebook 02). The first call of solids grows with the number of surface nodes, a solve with the whole mesh each;
# later ones cost what their number of points costs. Their elements are of first degree, which shows at these sizes.
# Cells that end with the contact reach an error with a fraction of the points of a grid.

# %%
truth = row(*clocked(0.3, surface_size=SIZE / 2, strips=FINEST[0], cells=FINEST[1]))
FORCES = ("normal force [N]", "creep force [N]")


def sizes(halved, **options):
    """Pairs of the size and of its halves."""
    return {f"{1e3 * size:g} mm": {**options, "surface_size": size} for size in SIZE * 0.5 ** np.arange(halved + 1)}


families = {
    "condensed solids": sizes(HALVED_SOLIDS, bodies="solid"),
    "2.5D, grid": sizes(HALVED_GRIDS, points="grid"),
    "2.5D, fitted": {f"{n} x {m}": {"surface_size": SIZE / 2, "strips": n, "cells": m} for n, m in FITTED},
}
costs = {
    name: pd.DataFrame({label: row(*clocked(0.3, **one)) for label, one in ways.items()}).T
    for name, ways in families.items()
}
if 0.3 in FRICTIONS:
    costs = {"full": pd.DataFrame({f"{1e3 * SIZE:g} mm": row(*found["full", 0.3])}).T, **costs}
for table in costs.values():
    for force in FORCES:
        table[force.replace("[N]", "error [%]")] = 100 * abs(table[force] / truth[force] - 1)
print(pd.concat(costs).to_string(float_format="{:.5g}".format))

cost_figure, panels = plt.subplots(1, 2, figsize=(10, 4), layout="constrained", sharey=True)
for ax, force in zip(panels, FORCES, strict=True):
    error = force.replace("[N]", "error [%]")
    series = {name: (table["again [s]"], table[error]) for name, table in costs.items()}
    wr.plot_work_precision(series, xlabel="time of a solve, bodies known [s]", ylabel="error [%]", ax=ax)
    ax.set_title(force.removesuffix(" [N]"))
fitted = costs["2.5D, fitted"]
assert fitted["normal force error [%]"].iloc[-1] < 0.3
assert fitted["normal force error [%]"].is_monotonic_decreasing
assert abs(costs["2.5D, grid"]["normal force error [%]"]).max() < 10

# %% [markdown]
# ## Which one when
#
# - **2.5D with fitted cells**, the default: rails, wheels (waves around the axle instead of along $x$) and anything
#   else that is the same in every section. Some ten milliseconds a solve, a few once it follows a contact from step to
#   step, so it can stand inside a vehicle simulation.
# - **Condensed solids**, where bodies are not invariant, or to have the paper's model: seconds to minutes once for each
#   mesh, then as quick.
# - **Full**, to check the others, and where bodies stop being linear. It is the only one that MPI spreads over
#   machines.
# - **Regular grid**: with the paper's penalty law, whose pressure fades out and has no edge to fit cells to.
