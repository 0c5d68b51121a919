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
#    contact points can be at any $x$: **strips** that end at the patch edge.

# %%
import inspect
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import wheelrail as wr
from wheelrail.contact import ContactLaws, Discretisation, Material, RigidMotion, Twist, hertz_pair
from wheelrail.contact.laws.normal import Penalty
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full.model import FullStart
from wheelrail.forms import elasticity, traction
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
FRICTIONS = (0.0, 0.3)  # for the comparison with the full model
SIZE = 1.6e-3  # m, surface size of this comparison: coarse, because of the full model
HALVED_SOLIDS = 1  # number of halvings of the size, condensed solids
HALVED_GRIDS = 3  # the same, regular grids on waveguides
LATTICES = ((8, 6), (8, 10), (12, 10), (16, 10), (24, 16))  # strips and cells
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
        "unknowns": start.displacement.size
        if isinstance(start, FullStart)
        else points * (3 if data.traction.any() else 1),
        "normal force [N]": data.vertical_force.item(),
        "creep force [N]": data.longitudinal_force.item(),
    }


MODELS = {
    "full": {"model": "full", "surface_size": SIZE},
    "condensed": {"bodies": "solid", "surface_size": SIZE},
    "2.5D, grid": {"points": "grid", "surface_size": SIZE},
    "2.5D, strips": {"surface_size": SIZE / 2},
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

# %% [markdown]
# ## The weak form, line by line
#
# The full model is the weak form of the paper. The equations (2) to (6) are UFL, shown next to the code that the solver
# uses; (12) and (20) are checked with its own matrices.
#
# **Navier's equations (2), virtual work (3).** For both bodies, $a(u, v) = \int \sigma(u) : \varepsilon(v)\,dV$ and
#
# $$ a_w(u_w, v_w) + a_r(u_r, v_r) = \int_\Gamma t(d, s)\cdot(v_w - v_r\circ\Phi)\,dA, $$
#
# $\Phi$ the contact map from the wheel's surface $\Gamma$ to the rail's.

# %%
for function in (elasticity.strain, elasticity.stress, elasticity.stiffness, traction.virtual_work):
    print(inspect.getsource(function))

# %% [markdown]
# **Normal law (4)**, $p_n = K\max(d, 0)$, and **friction (6)**, $p_t = -\mu p_n\, s / \max(|s|, \varepsilon)$, from the
# penetration $d$ and the slip $s$ of the deformed bodies. The same expressions, differentiated by UFL, serve the
# condensed and the model of strips as compiled functions: one law for all models, and laws of your own.

# %%
for function in (Penalty.pressure, traction.regularised, traction.traction):
    print(inspect.getsource(function))

# %% [markdown]
# **Discrete problem (12).** Penetration and slip at the contact points are coefficients of the traction. They are
# affine in the displacements $U = (U_w, U_r)$ of both meshes, $z = (d, s) = z_0 + G U$, with the undeformed penetration
# and the rigid creepage in $z_0$; nodal quadrature of the virtual work gives the nodal forces $T(z)$. Forms of dolfinx
# integrate over one mesh: the trace $v_r\circ\Phi$ on another mesh, whose points change with the pose, is the sparse
# operator $B_r$, and $B = (B_w, -B_r)$ applies the same forces to both bodies:
#
# $$ F(U) = K U - B^{\mathsf T}\,T(z_0 + G U) = 0, \qquad J = K - B^{\mathsf T}\,\frac{\mathrm dT}{\mathrm dz}\,G. $$
#
# dolfinx's NewtonSolver finds $U$, with PETSc's BiCGStab for $J\,\delta U = -F$. Below, $F$ and $J$ are evaluated at
# the solution from the solver's own parts, and $J$ is compared with a difference of $F$ (20).

# %%
how = Discretisation(SIZE, model="full")
pair = hertz_pair((RADII, FLAT), (Material(), Material()), ContactLaws.penalty(0.3), how, approach=exact.approach)
still = np.zeros(3)
upper, lower = (Twist(np.array([v, 0.0, 0.0]), still, still) for v in (-9.995, -10.005))
result = pair(hertz_pose(exact.approach), RigidMotion(upper, lower))
solver, U = pair.solver, result.warm_start.displacement
problem = solver.problem  # T, B^T, G and z0 of this pose


def product(v):
    """K v, from PETSc's matrix of both bodies."""
    x, y = solver.stiffness.createVecs()
    x.array[:] = v
    solver.stiffness.mult(x, y)
    return y.array_r.copy()


def residual(u):
    """F(U) = K U - B^T T(z0 + G U)."""
    return product(u) - problem.contact_forces(u)


def jacobian_product(u, v):
    """J v = K v - B^T D G v, D = dT/dz the derivative of the law by UFL."""
    z, _ = problem.state(u)
    D = problem.law.tangent(problem.nodes, z)
    Gv = (problem.gradient @ v).reshape(problem.law.components, -1)
    return product(v) - problem.forces @ np.einsum("nij,jn->in", D, Gv).ravel()


scale = np.linalg.norm(problem.contact_forces(U))
direction = product(U) / np.linalg.norm(product(U)) * np.linalg.norm(U)
step = 1e-7
difference = (residual(U + step * direction) - residual(U - step * direction)) / (2 * step)
exact_product = jacobian_product(U, direction)
residual_norm = np.linalg.norm(residual(U)) / scale
jacobian_error = np.linalg.norm(difference - exact_product) / np.linalg.norm(exact_product)
print(f"{len(U)} unknowns, {len(problem.nodes)} contact points: {result.status}")
print(f"Newton steps {result.statistics.newton}, iterations of BiCGStab {result.statistics.linear}")
print(f"|F| / |B^T T| = {residual_norm:.1e}; J v against a difference of F: {jacobian_error:.1e}")
assert residual_norm < 1e-8
assert jacobian_error < 1e-4

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
# have elements of first degree, whose error is visible at these sizes. Strips need a fraction of the points of a
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
    "2.5D, strips": {f"{n} x {m}": {"surface_size": SIZE / 2, "strips": n, "cells": m} for n, m in LATTICES},
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
strips = costs["2.5D, strips"]
assert strips["normal force error [%]"].iloc[-1] < 0.3
assert strips["normal force error [%]"].is_monotonic_decreasing
assert abs(costs["2.5D, grid"]["normal force error [%]"]).max() < 10

# %% [markdown]
# ## Choice of the model
#
# - **2.5D with strips**, the default: rails, wheels (waves about the axle instead of along $x$) and all other
#   bodies with a constant cross-section. About ten milliseconds per solve, a few with warm starts, which is fast enough
#   for vehicle simulation.
# - **Condensed solids**, for bodies with a variable cross-section, or for the paper's model: seconds to minutes once
#   per mesh, then equally fast.
# - **Full**, for verification of the others, and for nonlinear bodies. It is the only model that is distributed by MPI.
# - **Regular grid**: for the paper's penalty law, which has no sharp patch edge.
