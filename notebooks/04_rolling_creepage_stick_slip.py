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
# # Rolling: creepage, stick and slip
#
# A wheel that drives, brakes or is steered rolls a little faster or slower than its rail passes by. The difference over
# the speed is the **creepage**: $\xi$ along the track, $\eta$ across it, and the **spin** $\varphi$ [rad/m] about the
# contact normal. Here they are those of the upper body minus those of the lower one, so the force on the upper body
# points the other way. In the patch, with $x$ forward, the rigid surfaces would slide by
#
# $$ w_x = V(\xi - \varphi y), \qquad w_y = V(\eta + \varphi x), $$
#
# and elasticity takes up what it can. Steady rolling carries material backwards through the patch, so that the true
# slip is
#
# $$ s = w - V\,\frac{\partial u}{\partial x}, \qquad
#    |\tau| \le \mu p, \qquad \tau = -\mu p\,\frac{s}{|s|}\ \text{ wherever } s \ne 0 , $$
#
# with $u$ the tangential displacement of the upper surface against the lower one. Material enters unstressed at the
# leading edge ($x > 0$), sticks, shears more and more, and slips where $\mu p$, which falls towards the trailing edge,
# no longer holds it.

# %%
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from wheelrail.contact.analytical.kalker import kalker
from wheelrail.scenes.plots.style import SERIES, STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
EVERY = 1  # of CONTACT's creepages, each one
CELLS = {"strips": 12, "cells": 16}  # strips over the patch, cells along each

# %% [markdown]
# ## Three creep curves
#
# The reference is CONTACT (E. Vollebregt, revision 2707), a boundary element code for half-spaces, extrapolated from
# three grids: forces over $\mu N$ for three ellipses. We take the circle, and beside it what multibody codes use:
# **FASTSIM** (`model="standard"`), in which springs under every point of the surface, stiff enough to give Kalker's
# linear theory, replace the elastic bodies.

# %%
stored = json.loads((Path(wr.__file__).parents[1] / "benchmarks/reference/creep_curves.json").read_text())
MU, LOAD, E, NU = 0.3, 57e3, 2.1e11, 0.3
G = E / (2 + 2 * NU)
ellipses = {curve["ratio"]: curve for curve in stored["curves"]}


def ellipse(ratio, **options):
    """Pair with semi-axes a (along) and b in this ratio, on a flat block."""
    radii = [1e-3 * ellipses[ratio][name] for name in ("Rx", "Ry")]
    return wr.Hertz(radii, (np.inf, np.inf), friction=MU, E=E, nu=NU, load=LOAD, **options)


def forces(solution):
    """Fx and Fy on the upper body over mu N."""
    own = solution.data.sel(side="contact")
    return np.array([own.longitudinal_force, own.lateral_force]) / (MU * LOAD)


circle, fastsim = ellipse(1.0, **CELLS), ellipse(1.0, model="standard", normal="hertz")
a, b = circle.closed_form(load=LOAD).semi_axes
table = {name: kalker(name, a / b, NU) for name in ("C11", "C22", "C23")}
print(f"a = b = {1e3 * a:.3f} mm;", ", ".join(f"{name} = {value:.3f}" for name, value in table.items()))

curves = {}
for kind in ("long", "lat", "spin"):
    cases = np.array([case[1:6] for case in ellipses[1.0]["cases"] if case[0] == kind])[::EVERY]
    creepages = cases[:, :3] * [1, 1, 1e3]  # the file's spin is per mm
    curves[kind] = {
        "creepage": creepages,
        "finite elements": np.array([forces(circle.solve(creepage=creep)) for creep in creepages]),
        "FASTSIM": np.array([forces(fastsim.solve(creepage=creep)) for creep in creepages]),
        "CONTACT": cases[:, 3:],
    }

# %% [markdown]
# Kalker's linear theory, $F_x = -abG\,C_{11}\,\xi$ and $F_y = -abG\,(C_{22}\,\eta + \sqrt{ab}\,C_{23}\,\varphi)$, is
# the tangent at the origin. Spin is the odd one: at first it pushes the wheel sideways, but once the patch turns as a
# whole the shears of its two halves cancel, so the force has a largest value and falls again.

# %%
LOOK = {  # column of the creepage, factor, label; column of the force; force of the linear theory over creepage
    "long": (0, 1e3, "longitudinal creepage ξ [10⁻³]", 0, a * b * G * table["C11"]),
    "lat": (1, 1e3, "lateral creepage η [10⁻³]", 1, a * b * G * table["C22"]),
    "spin": (2, 1.0, "spin φ [rad/m]", 1, (a * b) ** 1.5 * G * table["C23"]),
}
figure, panels = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
for ax, (kind, (column, factor, label, row, slope)) in zip(panels, LOOK.items(), strict=True):
    found, own = curves[kind], curves[kind]["creepage"][:, column]
    for name, look in (("finite elements", SERIES[0]), ("FASTSIM", SERIES[2]), ("CONTACT", SERIES[1])):
        style = {"marker": "s", "ls": "none", "mfc": "none"} if name == "CONTACT" else {"ls": look["linestyle"]}
        # the force on the lower body has the sign of the creepage
        ax.plot(factor * abs(own), -np.sign(own) * found[name][:, row], color=look["color"], label=name, **style)
    ax.plot([0.0, factor * MU * LOAD / slope], [0.0, 1.0], color="0.5", ls=":", label="Kalker's linear theory")
    ax.set(xlabel=label, ylabel="F" + "xyy"[column] + " on the lower body / µN [1]")
    ax.set(ylim=(0, 1.05), xlim=(0, factor * abs(own).max() * (0.5 if kind != "spin" else 1.0)))
panels[0].legend()
error = {
    name: np.concatenate([curve[name] - curve["CONTACT"] for curve in curves.values()])
    for name in ("finite elements", "FASTSIM")
}
for name, e in error.items():
    print(f"{name}: {100 * np.sqrt((e**2).mean()):.2f} % of µN RMS, {100 * abs(e).max():.2f} % at worst")
assert abs(error["finite elements"]).max() < 0.015
assert abs(error["FASTSIM"]).max() > 3 * abs(error["finite elements"]).max()

# %% [markdown]
# ## Kalker's coefficients
#
# At a creepage of $10^{-6}$ next to nothing slips, and the forces per creepage are Kalker's coefficients: a test of the
# whole chain (compliance of the bodies, cells, upstream slip) that no friction can hide. Kalker's table E.3 has three
# digits and is itself good to about 1 %.

# %%
measured = {}
for ratio in ellipses:
    pair = ellipse(ratio, **CELLS)
    c, tiny = np.sqrt(np.prod(pair.closed_form(load=LOAD).semi_axes)), 1e-6
    along, across, spun = (forces(pair.solve(creepage=creep)) for creep in np.diag([tiny, tiny, tiny / c]))
    measured[ratio] = -np.array([along[0], across[1], spun[1]]) * MU * LOAD / (G * c**2 * tiny)
coefficient_figure, ax = plt.subplots(figsize=(5.6, 4.0), layout="constrained")
ratios = np.geomspace(0.2, 5, 60)
for k, name in enumerate(table):
    look = SERIES[k]
    ax.plot(ratios, [kalker(name, r, NU) for r in ratios], color=look["color"], ls=look["linestyle"])
    ax.plot(list(measured), [C[k] for C in measured.values()], look["marker"], color=look["color"], label=name)
    known = [(row["ratio"], row[name]) for row in stored["kalker"] if row["nu"] == NU]
    ax.plot(*zip(*known, strict=True), "+", color="0.2", ms=11, label="CONTACT" if k == 2 else None)
ax.set(xscale="log", xlabel="a / b, semi-axis along over across [1]", ylabel="coefficient [1]")
ax.set(title="coloured points: finite elements; lines: Kalker's table", xticks=[0.2, 0.5, 1, 2, 5])
ax.xaxis.set_major_formatter("{x:g}")
ax.xaxis.set_minor_formatter("")
ax.legend()
beside = np.array([[C[k] / kalker(name, r, NU) - 1 for k, name in enumerate(table)] for r, C in measured.items()])
print("C11, C22, C23 beside the table, in %, by a / b:", *np.round(100 * beside, 2), sep="\n")
assert abs(beside).max() < 0.02

# %% [markdown]
# ## Where it slips, and which way
#
# Four kinds of motion. Blue sticks, orange slips; dark arrows are the traction on the upper body, orange ones the slip
# of the upper body against the lower one: opposite, as Coulomb wants. With longitudinal creepage the patch sticks in
# the lens at the leading edge that textbooks show; with spin the slip circles around a point that sticks.

# %%
full_long, full_lat, full_spin = (MU * LOAD / slope for *_, slope in LOOK.values())  # where the linear theory ends
MOTIONS = {
    "driving, ξ": (-full_long, 0.0, 0.0),
    "sideways, η": (0.0, -full_lat, 0.0),
    "spin, φ": (0.0, 0.0, 0.5 * full_spin),
    "all three": (-0.5 * full_long, -0.5 * full_lat, 0.5 * full_spin),
}
map_figure, panels = plt.subplots(2, 2, figsize=(9.2, 9.6), layout="constrained")
sticks = {}
for ax, (name, creep) in zip(panels.flat, MOTIONS.items(), strict=True):
    solution = circle.solve(creepage=creep)
    solution.plot.tractions(ax=ax)
    patch = solution.patches.iloc[0]
    sticks[name] = patch.stick_area / patch.area
    ax.set_title(name)
print("share of the patch that sticks:", {name: round(share, 2) for name, share in sticks.items()})
assert all(0.25 < share < 0.75 for share in sticks.values())

# %% [markdown]
# Along the middle line the shear climbs from the leading edge (right) until it meets $\mu p$: on elastic bodies slowly
# at first and then ever steeper, to a cusp where slip begins. The springs of FASTSIM do not feel each other, so theirs
# climbs in a straight line. Its bound is a parabola of the same load and not Hertz's ellipse, which is why its shear
# passes the dotted line.

# %%
section_figure, panels = plt.subplots(1, 2, figsize=(9.2, 3.8), layout="constrained", sharey=True)
for ax, (name, pair) in zip(panels, {"finite elements": circle, "FASTSIM": fastsim}.items(), strict=True):
    pair.solve(creepage=MOTIONS["driving, ξ"]).plot.section("x", hertz=False, ax=ax)
    ax.set_title(name)

# %% [markdown]
# To take home: up to a third of saturation the linear theory is enough; from there to full slip the shape of the curve
# matters, and FASTSIM has it to a few per cent of $\mu N$, worst with large spin, which is where flanges live. Elastic
# bodies in the loop need no table, and no ellipse either.
