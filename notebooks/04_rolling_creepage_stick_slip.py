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
# The circumferential speed of a wheel that is driven, braked or steered differs slightly from the speed of travel. The
# velocity difference divided by the speed is the **creepage**: $\xi$ along the track, $\eta$ across it, and the
# **spin** $\varphi$ [rad/m] about the contact normal. They are defined as upper body minus lower body, so the force on
# the upper body has the opposite direction. In the patch, with $x$ forward, the rigid slip is
#
# $$ w_x = V(\xi - \varphi y), \qquad w_y = V(\eta + \varphi x), $$
#
# part of which is compensated by elastic deformation. In steady rolling material flows backwards through the patch, so
# that the true slip is
#
# $$ s = w - V\,\frac{\partial u}{\partial x}, \qquad
#    |\tau| \le \mu p, \qquad \tau = -\mu p\,\frac{s}{|s|}\ \text{ wherever } s \ne 0 , $$
#
# with $u$ the tangential displacement of the upper surface relative to the lower one. Material enters unstressed at the
# leading edge ($x > 0$) and sticks with increasing shear traction until it reaches $\mu p$, which decreases towards the
# trailing edge; from there on it slips.

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
EVERY = 1  # step through CONTACT's creepages; 1 takes all
CELLS = {"strips": 16, "cells": 16}  # strips over the patch, cells along each

# %% [markdown]
# ## Creep curves
#
# The reference is CONTACT (E. Vollebregt, revision 2707), a boundary element code for half-spaces, extrapolated from
# three grids: forces over $\mu N$ for three ellipses. The circular case is compared here, together with **FASTSIM**
# (`model="standard"`), the method of multibody codes, in which independent springs at the surface points, with
# stiffnesses from Kalker's linear theory, replace the elastic bodies.

# %%
stored = json.loads((Path(wr.__file__).parents[1] / "benchmarks/reference/creep_curves.json").read_text())
MU, LOAD, E, NU = 0.3, 57e3, 2.1e11, 0.3
G = E / (2 + 2 * NU)
ellipses = {curve["ratio"]: curve for curve in stored["curves"]}


def ellipse(ratio, **options):
    """Pair with semi-axes a (along) and b in this ratio; the lower body is flat."""
    radii = [1e-3 * ellipses[ratio][name] for name in ("Rx", "Ry")]
    return wr.Hertz(radii, (np.inf, np.inf), friction=MU, E=E, nu=NU, load=LOAD, **options)


def forces(solution):
    """Fx and Fy on the upper body over mu N."""
    data = solution.data.sel(side="contact")
    return np.array([data.longitudinal_force, data.lateral_force]) / (MU * LOAD)


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
# the tangent at the origin. The curve of spin is different: small spin causes a lateral force, but at large spin the
# tractions of the two halves of the patch cancel, so the force has a maximum and decreases again.

# %%
PANELS = {  # column of the creepage, factor, label; column of the force; force of the linear theory over creepage
    "long": (0, 1e3, "longitudinal creepage ξ [10⁻³]", 0, a * b * G * table["C11"]),
    "lat": (1, 1e3, "lateral creepage η [10⁻³]", 1, a * b * G * table["C22"]),
    "spin": (2, 1.0, "spin φ [rad/m]", 1, (a * b) ** 1.5 * G * table["C23"]),
}
figure, panels = plt.subplots(1, 3, figsize=(11, 3.6), layout="constrained")
for ax, (kind, (column, factor, label, row, slope)) in zip(panels, PANELS.items(), strict=True):
    forces_of, creepage = curves[kind], curves[kind]["creepage"][:, column]
    for name, line in (("finite elements", SERIES[0]), ("FASTSIM", SERIES[2]), ("CONTACT", SERIES[1])):
        style = {"marker": "s", "ls": "none", "mfc": "none"} if name == "CONTACT" else {"ls": line["linestyle"]}
        # the force on the lower body has the sign of the creepage
        ax.plot(
            factor * abs(creepage),
            -np.sign(creepage) * forces_of[name][:, row],
            color=line["color"],
            label=name,
            **style,
        )
    ax.plot([0.0, factor * MU * LOAD / slope], [0.0, 1.0], color="0.5", ls=":", label="Kalker's linear theory")
    ax.set(xlabel=label, ylabel="F" + "xyy"[column] + " on the lower body / µN [1]")
    ax.set(ylim=(0, 1.05), xlim=(0, factor * abs(creepage).max() * (0.5 if kind != "spin" else 1.0)))
panels[0].legend()
error = {
    name: np.concatenate([curve[name] - curve["CONTACT"] for curve in curves.values()])
    for name in ("finite elements", "FASTSIM")
}
for name, e in error.items():
    print(f"{name}: {100 * np.sqrt((e**2).mean()):.2f} % of µN RMS, {100 * abs(e).max():.2f} % at most")
assert abs(error["finite elements"]).max() < 0.015
assert abs(error["FASTSIM"]).max() > 3 * abs(error["finite elements"]).max()

# %% [markdown]
# ## Kalker's coefficients
#
# At a creepage of $10^{-6}$ almost the whole patch sticks, and force per creepage gives Kalker's coefficients: a test
# of compliance, cells and upstream difference that is independent of the friction law. Kalker's table E.3 has three
# digits and is itself accurate to about 1 %.

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
    line = SERIES[k]
    ax.plot(ratios, [kalker(name, r, NU) for r in ratios], color=line["color"], ls=line["linestyle"])
    ax.plot(list(measured), [C[k] for C in measured.values()], line["marker"], color=line["color"], label=name)
    contact = [(row["ratio"], row[name]) for row in stored["kalker"] if row["nu"] == NU]
    ax.plot(*zip(*contact, strict=True), "+", color="0.2", ms=11, label="CONTACT" if k == 2 else None)
ax.set(xscale="log", xlabel="a / b, semi-axis along over across [1]", ylabel="coefficient [1]")
ax.set(title="coloured points: finite elements; lines: Kalker's table", xticks=[0.2, 0.5, 1, 2, 5])
ax.xaxis.set_major_formatter("{x:g}")
ax.xaxis.set_minor_formatter("")
ax.legend()
deviation = np.array([[C[k] / kalker(name, r, NU) - 1 for k, name in enumerate(table)] for r, C in measured.items()])
print("C11, C22, C23: deviation from the table in %, by a / b:", *np.round(100 * deviation, 2), sep="\n")
assert abs(deviation).max() < 0.02

# %% [markdown]
# ## Stick and slip areas
#
# Four states of motion. Blue areas stick, orange areas slip; dark arrows are the traction on the upper body, orange
# arrows the slip of the upper body relative to the lower one, in the opposite direction according to Coulomb's law.
# With longitudinal creepage the stick area is the well-known lens at the leading edge; with spin the slip circulates
# about a sticking point.

# %%
full_long, full_lat, full_spin = (MU * LOAD / slope for *_, slope in PANELS.values())  # saturation by the linear theory
MOTIONS = {
    "driving, ξ": (-full_long, 0.0, 0.0),
    "lateral, η": (0.0, -full_lat, 0.0),
    "spin, φ": (0.0, 0.0, 0.5 * full_spin),
    "combined": (-0.5 * full_long, -0.5 * full_lat, 0.5 * full_spin),
}
map_figure, panels = plt.subplots(2, 2, figsize=(9.2, 9.6), layout="constrained")
stick = {}
for ax, (name, creep) in zip(panels.flat, MOTIONS.items(), strict=True):
    solution = circle.solve(creepage=creep)
    solution.plot.tractions(ax=ax)
    patch = solution.patches.iloc[0]
    stick[name] = patch.stick_area / patch.area
    ax.set_title(name)
print("stick area / patch area:", {name: round(fraction, 2) for name, fraction in stick.items()})
assert all(0.25 < fraction < 0.75 for fraction in stick.values())

# %% [markdown]
# On the centre line the shear traction increases from the leading edge (right) until it reaches $\mu p$: for elastic
# bodies with increasing slope, up to a cusp where slip begins. The springs of FASTSIM are independent, so that its
# traction increases linearly. Its bound is a parabola with the same load instead of Hertz's ellipse, so that its
# traction exceeds the dotted line.

# %%
section_figure, panels = plt.subplots(1, 2, figsize=(9.2, 3.8), layout="constrained", sharey=True)
for ax, (name, pair) in zip(panels, {"finite elements": circle, "FASTSIM": fastsim}.items(), strict=True):
    pair.solve(creepage=MOTIONS["driving, ξ"]).plot.section("x", hertz=False, ax=ax)
    ax.set_title(name)

# %% [markdown]
# In summary, the linear theory is sufficient up to a third of saturation. Between there and full slip the shape of the
# curve matters; FASTSIM reproduces it to a few per cent of $\mu N$, with the largest errors at large spin, which is
# typical of flange contact. Elastic bodies need neither tables of coefficients nor elliptical patches.
