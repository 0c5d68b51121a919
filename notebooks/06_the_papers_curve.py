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
# # The paper's curve
#
# Magheri, Malvezzi, Meli and Rindi ([2011](https://doi.org/10.1080/00423114.2010.504854)) drove the Manchester wagon at
# 45 m/s from a tangent through a transition into a left-hand curve of 1200 m with 60 mm of cant, with a finite-element
# contact problem behind every force that the integrator asked for. Here is that run with the exact contact laws: no
# penetration, and Coulomb's law without a regularisation.
#
# The vehicle is a section: car body, bogie and wheelset, each free to move sideways, up and down, and to roll. Only an
# eighth of the car body, a quarter of each bogie frame and one wheelset are in it; there is no yaw, and so no steering
# and no hunting. What it does show is how wheels and rails share the load between tread and flange.

# %%
from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from scenes.pictures.style import SIDES, STYLE
from vehicle.wagon import Wagon

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
CHANGES = {}  # to the scene: scenes/curve.toml as it is, 10 s on 4 x 10 cells a patch
OTHERS = ("standard contact", "paper's laws")  # what the run is compared with

# %% [markdown]
# A scene file says what to run; values can be replaced by their names in it. The contact problem is solved some five
# hundred times a side: the stepper is implicit (a Rosenbrock method of third order), with the contact's own tangent in
# its Jacobian, because a stiffness of a million N/mm would make an explicit one crawl.

# %%
scene = files("scenes") / "curve.toml"
run = wr.run(scene, **{"solver.workers": 1, **CHANGES})
run

# %% [markdown]
# ## Where the wagon goes
#
# The paper's Figs. 11 and 12. In the transition the wheelset moves out by 6 mm until its right flange meets the outer
# rail; without yaw nothing else turns it into the curve. The car body hangs over to the outside by 8 cm: the speed is too
# high for the cant.

# %%
moved = run.plot.displacements()

# %% [markdown]
# ## Forces on the wheels
#
# Figs. 13 to 16: $Y$ to the left, $Q$ upwards, on each wheel.

# %%
lateral = run.plot.lateral_forces()
vertical = run.plot.vertical_forces()

# %% [markdown]
# ## By hand
#
# The forces in the full curve need no program. Seen from the track, the plane of the rails is tilted by
# $\beta = \arcsin(h/b)$ and the wagon is pushed outwards with
#
# $$a = \frac{v^2}{R}\cos\beta - g \sin\beta , \qquad n = \frac{v^2}{R}\sin\beta + g \cos\beta .$$
#
# Both rails together bear $m n$, and against $m a$ they push inwards. About the middle of the track, at the height of
# the rails,
#
# $$(Q_\mathrm{r} - Q_\mathrm{l})\, \tfrac{e}{2} = \sum_i m_i \,(a\, z_i + n\, u_i) ,$$
#
# with heights $z_i$ and displacements to the outside $u_i$ of car body, bogie and wheelset, and $e$ the distance between
# the contact points. The displacements are the run's own: without the hanging car body, 8 kN of the load transfer would be
# missing. (The wheelset's gyroscopic moment, 0.4 kN m, is the one thing that is added.)

# %%
section, end = Wagon().plane, run.data.isel(time=-1)  # one wheelset's share of everything
speed, curvature, cant, base = 45.0, 1 / 1200, 0.06, 1.5
tilt = np.arcsin(cant / base)
outwards = speed**2 * curvature * np.cos(tilt) - section.gravity * np.sin(tilt)
downwards = speed**2 * curvature * np.sin(tilt) + section.gravity * np.cos(tilt)
bodies = {"car_body": section.car_body, "bogie": section.bogie, "wheelset": section.wheelset}
mass = sum(body.mass for body in bodies.values())
moment = sum(
    body.mass * (outwards * body.height - downwards * float(end[f"{name}_y"])) for name, body in bodies.items()
)
spin = speed / section.radius
moment += section.wheelset.pitch_inertia * spin * speed * curvature * np.cos(tilt)
print(f"{outwards:.2f} m/s2 outwards, as with {1e3 * base * outwards / section.gravity:.0f} mm of cant missing")

# %%
at = (end.rail_y * end.patch_normal_force).sum("patch") / end.patch_normal_force.sum("patch")
shift = {side: float(at.sel(side=side)) for side in SIDES}  # of the load, from the top of each rail to its field side
rail = wr.Wheelset("S1002", "60E1").mounting.rail_y  # m from the middle of the track to the top of the rail
left, right = (float(end.vertical_force.sel(side=side)) for side in SIDES)
across, aside = 2 * rail + shift["left"] + shift["right"], 0.5 * (shift["right"] - shift["left"])
by_hand = {
    "both wheels, Q": (mass * downwards, left + right),
    "both wheels, Y": (mass * outwards, float(end.lateral_force.sum())),
    "load transfer": (2 * (moment - mass * downwards * aside) / across, right - left),
}
for name, (expected, found) in by_hand.items():
    print(f"{name:15} by hand {1e-3 * expected:7.2f} kN, in the run {1e-3 * found:7.2f} kN, {found / expected - 1:+.2%}")

# %% [markdown]
# What is left is motion: after some seconds in the curve the car body still rolls a little, and the lateral forces act
# some millimetres below the top of the rails.
#
# The lateral forces are shared out unevenly: the inner wheel takes next to nothing, and the outer one all that the curve
# asks for. Longitudinal forces show what the missing yaw costs: $\pm 10$ kN against each other, a steering moment that
# in a real bogie would turn the wheelset until it is small.
#
# ## Where wheels and rails touch
#
# Figs. 17 to 20, the paper's signature: the lateral extent of every patch along the track, here shaded by its peak
# pressure. On the outer wheel the tread's patch narrows on its way to the gauge corner. Then a second one appears at the
# flange root, 1 to 2 mm wide with more than 2000 MPa. For some metres both carry; then tread or flange has it alone.

# %%
on_wheel = run.plot.bands("wheel")
on_rail = run.plot.bands("rail")

# %% [markdown]
# ## Other laws, another model
#
# The same scene with other keys:
#
# - the **standard contact** of multibody codes, rigid profiles with virtual penetration and FASTSIM;
# - the **paper's laws**: a penalty, $p = K\,\delta$ with $K = 10^{15}$ N/m³, in place of $p \ge 0,\ d \ge 0,\ p d = 0$, and
#   friction that grows with the slip before it reaches $\mu p$, on a regular grid of 2 mm instead of fitted cells.

# %%
bare = {**CHANGES, "solver.workers": 1, "strips": None, "cells": None}  # cells belong to the exact laws
variants = {
    "standard contact": {**bare, "model": "standard", "laws": None, "surface_size": None},
    "paper's laws": {**bare, "laws": "paper", "bodies": "waveguide", "surface_size": 2e-3},
}
runs = {"exact laws": run.data, **{name: wr.run(scene, **variants[name]).data for name in OTHERS}}
LOOKS = dict(zip(("exact laws", *variants), (("#0072B2", "-"), ("#D55E00", "--"), ("#009E73", ":")), strict=True))
panels = (
    ("lateral_force", "right", 1e-3, "lateral force, right wheel [kN]"),
    ("patch_max_pressure", "right", 1e-6, "peak pressure, right wheel [MPa]"),
    ("t_gamma", "left", 1.0, "T-gamma, left wheel [N]"),
    ("t_gamma", "right", 1.0, "T-gamma, right wheel [N]"),
)
compared, axes = plt.subplots(4, 1, figsize=(7.4, 8.6), sharex=True, layout="constrained")
for ax, (variable, side, scale, label) in zip(axes, panels, strict=True):
    for name, data in runs.items():
        values = data[variable].sel(side=side)
        values = values.max("patch") if "patch" in values.dims else values
        colour, dashes = LOOKS[name]
        ax.plot(data.distance, scale * values, color=colour, linestyle=dashes, label=name)
    ax.set_ylabel(label)
axes[0].legend(ncols=3)
axes[-1].set_xlabel("distance along the track [m]");

# %% [markdown]
# Forces follow from equilibrium, so the models differ little where nothing moves. Pressures do not: on a grid of 2 mm a
# flange patch of 1.5 mm is one point wide, and its peak jumps as points enter and leave. The fitted cells of the exact
# laws end where the contact ends, and the curve is smooth.
#
# ## Wear, from the same numbers
#
# T-gamma is the heat that friction makes on a metre of track, $T\gamma = \frac{1}{v}\int \mathbf p_t \cdot \mathbf s\,dA$,
# and wear laws take it for their input. Over the whole run:

# %%
for name, data in runs.items():
    heat = np.trapz(data.t_gamma, data.distance, axis=0) / 1e3
    print(f"{name:17} {heat[0]:5.2f} kJ left, {heat[1]:5.2f} kJ right")

# %%
assert run.status == "completed"
for expected, found in by_hand.values():
    assert abs(found / expected - 1) < 0.025
assert -6.4e-3 < float(end.wheelset_y) < -6.1e-3 and -0.09 < float(end.car_body_y) < -0.07
np.testing.assert_allclose(end.t_gamma, end.frictional_power / speed, rtol=1e-12)
flange = run.data.wheel_y.sel(side="right").min("patch")
assert run.data.wheelset_y.values[np.argmax(flange.values < -0.025)] < -5e-3  # the flange comes within a millimetre
for name in OTHERS:
    assert abs(float(runs[name].vertical_force.isel(time=-1).sel(side="right")) / right - 1) < 0.03, name
