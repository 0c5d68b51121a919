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
# Magheri, Malvezzi, Meli and Rindi ([2011](https://doi.org/10.1080/00423114.2010.504854)) simulated the Manchester
# wagon at 45 m/s on a tangent, a transition and a left-hand curve of 1200 m radius with 60 mm of cant, with a
# finite-element contact problem solved at every force evaluation. This notebook repeats the run with the exact contact
# laws: unilateral contact, and Coulomb's law without regularisation.
#
# The vehicle model is plane: car body, bogie and wheelset, each with lateral and vertical displacement and roll. It
# consists of one wheelset, a quarter of the car body and half a bogie frame; there is no yaw, hence no steering and no
# hunting. It does represent the distribution of the load between tread and flange.

# %%
from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from wheelrail.scenes.plots.style import SIDES, STYLE
from wheelrail.vehicle.wagon.wagon import Wagon

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
CHANGES = {}  # of the scene; scenes/curve.toml: 10 s, 8 strips x 10 cells per patch
SIZES = {"exact laws": 1e-3, "paper's laws": 2e-3, "paper's laws, finer": 1e-3}  # m, spacing of surface points

# %% [markdown]
# A scene file defines the run; single values can be replaced by their dotted names. The contact problem is solved about
# five hundred times per side: time integration is implicit (a Rosenbrock method of third order) with the contact
# tangent in its Jacobian, because a contact stiffness of a million N/mm would limit explicit methods to very small
# steps.

# %%
scene = files("wheelrail.scenes") / "examples" / "curve.toml"
run = wr.run(scene, **{"solver.workers": 1, **CHANGES})
print(run)

# %% [markdown]
# ## Displacements
#
# Figs. 11 and 12 of the paper. In the transition the wheelset moves outwards by 6 mm; flange contact of the right wheel
# with the outer rail begins at 5 mm. The car body is displaced to the outside by 8 cm, because of the cant deficiency.

# %%
displacements = run.plot.displacements()

# %% [markdown]
# ## Forces on the wheels
#
# Figs. 13 to 16: $Y$ (positive to the left) and $Q$ (positive upwards) on each wheel.

# %%
lateral = run.plot.lateral_forces()
vertical = run.plot.vertical_forces()

# %% [markdown]
# ## Static equilibrium by hand
#
# The forces in the full curve can be calculated by hand. The plane of the rails is inclined by $\beta = \arcsin(h/b)$,
# and in the frame of the track the accelerations outwards and normal to this plane are
#
# $$a = \frac{v^2}{R}\cos\beta - g \sin\beta , \qquad n = \frac{v^2}{R}\sin\beta + g \cos\beta .$$
#
# Both rails together carry the load $m n$, and the inward force $m a$. The moments about the track centre, at the
# height of the rails, give
#
# $$(Q_\mathrm{r} - Q_\mathrm{l})\, \tfrac{e}{2} = \sum_i m_i \,(a\, z_i + n\, u_i) ,$$
#
# with heights $z_i$ and displacements to the outside $u_i$ of car body, bogie and wheelset, and $e$ the distance
# between the contact points. The displacements are taken from the run: the displacement of the car body contributes 8
# kN of the load transfer. (The gyroscopic moment of the wheelset, 0.4 kN m, is added.)
#
# Some seconds into the curve the car body still has a small roll oscillation, and the forces oscillate with it. All
# quantities are therefore averaged over the last second, in which the mean force also changes the momentum:
# $\Delta P / \Delta t$ is computed from the velocities at both ends of the interval, and so is the change of the
# angular momentum $\sum_i (I_i \dot{\varphi}_i - m_i z_i \dot{y}_i)$ about the track.

# %%
section = Wagon().plane  # the fractions of one wheelset
speed, curvature, cant, base = 45.0, 1 / 1200, 0.06, 1.5
tilt = np.arcsin(cant / base)
outwards = speed**2 * curvature * np.cos(tilt) - section.gravity * np.sin(tilt)
downwards = speed**2 * curvature * np.sin(tilt) + section.gravity * np.cos(tilt)
print(f"{outwards:.2f} m/s2 outwards, equivalent to {1e3 * base * outwards / section.gravity:.0f} mm cant deficiency")

# %%
last = run.data.sel(time=slice(float(run.data.time[-1]) - 1.0, None))
mean = last.mean("time")


def acceleration(body: str, coordinate: str) -> float:
    rate = last[f"body_{coordinate}_rate"].sel(body=body)
    return float(rate[-1] - rate[0]) / float(last.time[-1] - last.time[0])


bodies = {"car_body": section.car_body, "bogie": section.bogie, "wheelset": section.wheelset}
lateral, upwards, moment = 0.0, 0.0, 0.0  # N and N m, forces and moment of the rails
for name, body in bodies.items():
    inertia = body.mass * (outwards + acceleration(name, "y"))
    lateral += inertia
    upwards += body.mass * (downwards + acceleration(name, "z"))
    moment += inertia * body.height - body.mass * downwards * float(mean.body_y.sel(body=name))
    moment -= body.roll_inertia * acceleration(name, "roll")
spin = speed / section.radius
moment += section.wheelset.pitch_inertia * spin * speed * curvature * np.cos(tilt)

# %%
normal_force = mean.patch_normal_force
centre = (mean.rail_y * normal_force).sum("patch") / normal_force.sum("patch")
offset = {side: float(centre.sel(side=side)) for side in SIDES}  # of the load, from the rail top to the field side
rail = wr.Wheelset("S1002", "60E1").mounting.rail_y  # m, from the track centre to the top of the rail
left, right = (float(mean.vertical_force.sel(side=side)) for side in SIDES)
distance, eccentricity = 2 * rail + offset["left"] + offset["right"], 0.5 * (offset["right"] - offset["left"])
by_hand = {
    "both wheels, Q": (upwards, left + right),
    "both wheels, Y": (lateral, float(mean.lateral_force.sum())),
    "load transfer": (2 * (moment - upwards * eccentricity) / distance, right - left),
}
for name, (expected, force) in by_hand.items():
    print(f"{name:15} by hand {1e-3 * expected:7.2f} kN, run {1e-3 * force:7.2f} kN, {force / expected - 1:+.2%}")

# %% [markdown]
# The remaining difference is due to the lateral forces, which act some millimetres below the top of the rails.
#
# The lateral forces are unequal: that of the inner wheel is almost zero, and the outer wheel carries nearly the whole
# lateral load. Longitudinal forces show the effect of the missing yaw: $\pm 10$ kN in opposite directions, a steering
# moment that in a real bogie would yaw the wheelset until it becomes small.
#
# ## Contact bands
#
# Figs. 17 to 20: the lateral extent of every patch along the track, here coloured by its peak pressure. On the outer
# wheel the tread patch becomes narrower as it moves to the gauge corner. Then a second patch forms at the flange root,
# 2 to 3 mm wide with more than 2000 MPa. Over 20 m both carry load; then the flange carries all of it.

# %%
on_wheel = run.plot.bands("wheel")
on_rail = run.plot.bands("rail")

# %% [markdown]
# ## Comparison with the standard contact
#
# The same scene with `model = "standard"`: rigid profiles with virtual penetration and FASTSIM, as in multibody codes,
# without the keys of elastic cells.

# %%
rigid = {"model": "standard", "laws": None, "surface_size": None, "strips": None, "cells": None}
runs = {"exact laws": run.data, "standard contact": wr.run(scene, **{**CHANGES, "solver.workers": 1, **rigid}).data}
STYLES = ({"color": "#0072B2"}, {"color": "#D55E00", "linestyle": (0, (4, 1.5))})
panels = (
    ("lateral_force", "right", 1e-3, "lateral force,\nright wheel [kN]"),
    ("patch_max_pressure", "right", 1e-6, "peak pressure,\nright wheel [MPa]"),
    ("t_gamma", "left", 1.0, "T-gamma,\nleft wheel [N]"),
    ("t_gamma", "right", 1.0, "T-gamma,\nright wheel [N]"),
)
compared, axes = plt.subplots(4, 1, figsize=(7.4, 7.6), sharex=True, layout="constrained")
for ax, (variable, side, scale, label) in zip(axes, panels, strict=True):
    for (name, data), style in zip(runs.items(), STYLES, strict=True):
        values = data[variable].sel(side=side)
        values = values.max("patch") if "patch" in values.dims else values
        ax.plot(data.distance, scale * values, label=name, **style)
    ax.set_ylabel(label)
axes[0].legend()
axes[-1].set_xlabel("distance along the track [m]")

# %% [markdown]
# Forces follow from equilibrium, so the models differ little in steady states; the transition from tread to flange
# contact differs by some metres. Peak pressures differ by a fifth over the whole distance, which is the main benefit of
# an elastic model.
#
# ## Effect of the paper's laws
#
# The paper replaces $p \ge 0,\ d \ge 0,\ p\,d = 0$ by a penalty, $p = K\,\delta$ with $K = 10^{15}$ N/m³, and Coulomb's
# law by one whose traction increases with the slip up to $\mu p$; contact points are the nodes of a regular grid. One
# sample of the run, at $y = -3$ mm with contact of the outer wheel at the gauge corner, is solved again with both laws
# (without the rates of the varying cant):

# %%
of_wheelset = run.data.sel(body="wheelset")
sample = of_wheelset.isel(time=int(np.argmax(of_wheelset.body_y.values < -3e-3)))
state = {key: float(sample[f"body_{key}"]) for key in ("y", "roll", "y_rate", "roll_rate")}
state["pitch_rate"] = speed / section.radius + float(sample.body_pitch_rate)  # rolling, and its excess
state |= {"speed": speed, "wheel_load": float(sample.vertical_force.sel(side="right")), "sides": ["right"]}
patches = {}
for name, size in SIZES.items():
    laws = {"laws": "paper", "bodies": "waveguide"} if "paper" in name else {}
    wheelset = wr.Wheelset("S1002", "60E1", curvature=float(sample.curvature), surface_size=size, **laws)
    patches[name] = wheelset.solve(**state).patches.iloc[0]
    patch = patches[name]
    creep = 1e-3 * np.hypot(patch.longitudinal_force, patch.lateral_force)
    values = f"{1e-6 * patch.max_pressure:5.0f} MPa, {1e6 * patch.area:5.1f} mm2, creep force {creep:.2f} kN"
    print(f"{name:20} {1e3 * size:g} mm: {values}")

# %% [markdown]
# At 1 mm the paper's laws have a small effect: $p_0/K$ is 1.3 µm, one or two per cent of the approach, and the peak
# pressure is lower by the same fraction. At 2 mm, the spacing of the paper, a patch 7 mm wide has three or four points
# across, and area and creep force have errors of a tenth. `scenes/paper_curve.toml` is the whole run with these laws.
#
# ## Wear
#
# T-gamma is the frictional work per metre of track, $T\gamma = \frac{1}{v}\int \mathbf p_t \cdot \mathbf s\,dA$, and
# the input of wear laws. Over the whole run:

# %%
for name, data in runs.items():
    heat = data.t_gamma.sel(wheelset="wheelset").integrate("time").values * speed / 1e3
    print(f"{name:17} {heat[0]:5.2f} kJ left, {heat[1]:5.2f} kJ right")

# %%
assert run.status == "completed"
for expected, force in by_hand.values():
    assert abs(force / expected - 1) < 0.01
assert -6.4e-3 < float(mean.body_y.sel(body="wheelset")) < -6.1e-3
assert -0.09 < float(mean.body_y.sel(body="car_body")) < -0.07
np.testing.assert_allclose(last.t_gamma, last.frictional_power / speed, rtol=1e-12)
flange = run.data.wheel_y.sel(side="right").min("patch").values < -0.025
first_contact = float(of_wheelset.body_y[np.argmax(flange)])
assert -5.4e-3 < first_contact < -4.0e-3  # of the first row: y changes by up to 0.3 mm between rows
rigid_mean = runs["standard contact"].vertical_force.sel(side="right", time=last.time).mean()
assert abs(float(rigid_mean) / right - 1) < 0.02
peaks = {name: patch.max_pressure for name, patch in patches.items()}
assert abs(peaks["paper's laws"] / peaks["exact laws"] - 1) < 0.1  # three or four points over the patch
assert abs(peaks.get("paper's laws, finer", np.inf) / peaks["exact laws"] - 1) < 0.02 or len(SIZES) == 2
