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
# # Profiles and contact geometry
#
# Contact geometry depends on two curves, the profiles of wheel and rail, and on the lateral position of the wheelset, a
# few millimetres to the left or right. The contact positions determine the rolling radii, and their difference steers
# the wheelset. In this notebook both bodies are rigid; from notebook 02 on they are elastic.
#
# Lengths in m, $x$ forward, $y$ to the left, $z$ up. On a profile $y$ is positive to the field side and $s$ is the arc
# length, measured from the rolling circle of the wheel or the top of the rail.

# %%
import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import wheelrail as wr
from wheelrail.scenes.plots.style import SERIES, SIDES, STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
POSITIONS = 321  # lateral positions of the wheelset, from 8 mm right to 8 mm left
ELASTIC = {"surface_size": 1e-3, "strips": 16, "cells": 10}  # for the elastic contacts at the end

# %% [markdown]
# ## Profiles
#
# 60E1, formerly UIC60 (EN 13674), consists of arcs, so its curvature is discontinuous in the middle of the running
# band, and so are quantities that depend on it. S1002 (EN 13715) has polynomials on the tread between the arcs of the
# flange and a straight outer part. Curvature is positive for convex profiles. In the flange root, between the tread and
# the 70 degree flange, the wheel is concave with a radius of 13 mm: there curvature is negative, and the gauge corner
# of the rail, also 13 mm, is nearly conformal.

# %%
wheel, rail = wr.profile("S1002"), wr.profile("60E1")
profile_figure, panels = plt.subplots(2, 2, figsize=(10, 4.8), layout="constrained", sharex="col")
for (outline, curvature), profile in zip(panels.T, (wheel, rail), strict=True):
    s = profile.samples(5e-5)
    y, z = 1e3 * profile.point(s).T
    outline.plot(y, z, color=SERIES[0]["color"])
    outline.set(title=f"{profile.kind} {profile.name}", xlabel="y, to the field side [mm]")
    outline.set_ylabel("from the axle outward [mm]" if profile is wheel else "z, up [mm]")
    outline.set_aspect("equal", adjustable="datalim")
    curvature.plot(y, profile.curvature(s), color=SERIES[1]["color"])
    curvature.set(xlabel="y, to the field side [mm]", ylabel="curvature [1/m]")
root_curvature = float(wheel.curvature(-0.041))
steepest = np.degrees(np.arctan2(*-wheel.tangent(-0.0443)[::-1]) % np.pi)
flange = 180 - steepest if steepest > 90 else steepest
tread = wheel.tangent(0.045)
print(
    f"flange root: {1e3 / root_curvature:.2f} mm; flange: {flange:.1f} degrees; tread 1 in {-tread[0] / tread[1]:.2f}"
)
assert abs(1 / root_curvature + 0.013) < 1e-5
assert abs(flange - 70) < 0.1
assert abs(-tread[0] / tread[1] - 15) < 0.05

# %% [markdown]
# ## Rigid contact positions
#
# `contact_geometry` lowers the rigid wheelset onto two rails, inclined at 1 in 40 with a gauge of 1435 mm, until both
# wheels are in contact; this determines the roll angle. **The contact position is discontinuous**: where the wheel is
# more concave than the rail is convex, no contact is possible, and the contact jumps across this part. Left of the
# first jump, at 0.2 mm, contact is on the tread; from 5 mm on in the flange root; from 6 mm on at the flange.

# %%
y = np.linspace(-8e-3, 8e-3, POSITIONS)
geometry = wr.contact_geometry(wheel, rail, y)
left = geometry.sel(side="left")

pair_figure, panels = plt.subplots(1, 2, figsize=(11, 2.4), layout="constrained")
for ax, position in zip(panels, (0.0, 6e-3), strict=True):
    wr.plot_profiles(wheel, rail, y=position, ax=ax)
    ax.set_title(f"left wheel, wheelset at y = {1e3 * position:g} mm")
    ax.set(xlim=(-45, 45), ylim=(-20, 12))

# %%
position_figure, panels = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained", sharex=True)
for side in ("left", "right"):
    contact = geometry.sel(side=side)
    panels[0].plot(1e3 * y, 1e3 * contact.rail_y, ".", ms=3, color=SIDES[side]["color"], label=f"{side} rail")
    panels[1].plot(1e3 * y, 1e3 * contact.wheel_y, ".", ms=3, color=SIDES[side]["color"], label=f"{side} wheel")
panels[0].set(ylabel="contact on the rail, y to the field side [mm]")
panels[1].set(ylabel="contact on the wheel, y to the field side [mm]")
for ax in panels:
    ax.set_xlabel("wheelset's lateral position, to the left [mm]")
    ax.legend()
jumps = np.abs(np.diff(left.wheel_y))
centre = jumps[np.abs(y[:-1]) < 1e-3].max()
print(f"jump of the left contact on the wheel: {1e3 * centre:.1f} mm near y = 0, {1e3 * jumps.max():.1f} mm at most")
assert centre > 8e-3

# %% [markdown]
# ## Rolling radii and equivalent conicity
#
# If the rolling radius $r_l$ of the left wheel is larger than the radius $r_r$ of the right one, a free wheelset yaws
# to the right, towards the track centre. To first order in yaw and displacement
#
# $$ \frac{d^2 y}{dx^2} + \frac{\Delta r(y)}{e\,r_0} = 0, \qquad \Delta r = r_l - r_r , $$
#
# with $e$ the distance between the rolling circles. For cones $\Delta r = 2\lambda y$, and the solution is Klingel's
# sine of wavelength $L = 2\pi\sqrt{e\,r_0/2\lambda}$. For other profiles the **equivalent conicity** $\lambda$ at an
# amplitude is that of the cones with the same wavelength. EN 15302 takes $\Delta r$ of a wheelset that does not roll.
# With its roll on both rails the conicity is a few per cent larger; it is checked here by integrating the equation of
# motion.

# %%
e, r0 = geometry.attrs["base"], geometry.attrs["nominal_radius"]
amplitude = 3e-3
conicity = float(np.interp(amplitude, geometry.amplitude, geometry.equivalent_conicity_with_roll))
klingel = 2 * np.pi * np.sqrt(e * r0 / (2 * conicity))


def kinematic_motion(x, state):
    """Derivatives of y and dy/dx."""
    return state[1], -np.interp(state[0], y, geometry.rolling_radius_difference) / (e * r0)


def zero_crossing(x, state):
    return state[0]


wave = solve_ivp(
    kinematic_motion, (0, 12), (amplitude, 0.0), events=zero_crossing, max_step=0.02, rtol=1e-8, atol=1e-10
)
half = float(np.diff(wave.t_events[0])[0])
print(f"conicity {conicity:.4f} at 3 mm; Klingel's wavelength {klingel:.3f} m, integrated {2 * half:.3f} m")

steering_figure, panels = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
panels[0].plot(1e3 * y, 1e3 * geometry.rolling_radius_difference, color=SERIES[0]["color"])
panels[0].set(xlabel="wheelset's lateral position, to the left [mm]", ylabel="rolling radius, left minus right [mm]")
panels[1].plot(
    1e3 * geometry.amplitude, geometry.equivalent_conicity_with_roll, color=SERIES[0]["color"], label="with roll"
)
panels[1].plot(
    1e3 * geometry.amplitude, geometry.equivalent_conicity, color=SERIES[0]["color"], ls=":", label="EN 15302"
)
panels[1].plot(1e3 * amplitude, conicity, "o", color=SERIES[1]["color"], label=f"{conicity:.3f} at 3 mm")
panels[1].set(xlabel="amplitude [mm]", ylabel="equivalent conicity [1]", ylim=(0, 0.7))
panels[1].legend()
panels[2].plot(wave.t, 1e3 * wave.y[0], color=SERIES[0]["color"], label="integrated")
sine = 1e3 * amplitude * np.cos(2 * np.pi * wave.t / klingel)
panels[2].plot(wave.t, sine, color=SERIES[1]["color"], ls="--", label="equivalent cones (Klingel)")
panels[2].set(xlabel="distance along the track [m]", ylabel="y of the wheelset, to the left [mm]")
panels[2].legend()
at_3 = float(np.interp(3e-3, y, geometry.rolling_radius_difference))
assert abs(at_3 - 0.96e-3) < 0.02e-3
assert abs(conicity - 0.178) < 0.005  # S1002 on UIC60 1:40, gauge 1435 mm
assert abs(2 * half / klingel - 1) < 0.01
assert np.allclose(geometry.rolling_radius_difference, -geometry.rolling_radius_difference[::-1], atol=1e-9)

# %% [markdown]
# ## Two contacts
#
# Where the rigid contact jumps, there are two simultaneous contacts. For rigid bodies this occurs at a single position
# $y$, and $\Delta r$ has a step there. For elastic bodies the second contact closes before the first one opens, and
# both carry load over a range of $y$. For S1002 on 60E1 this occurs with the wheelset centred, its most frequent
# position: at $y = 0$ one patch, 18 mm wide, has two pressure maxima. The dashed line is Hertz's pressure for the
# curvatures in its middle: 505 MPa, compared with 780 MPa. At 3 mm the contact is nearly elliptical, and Hertz's theory
# applies.

# %%
elastic = wr.Wheelset(wheel, rail, friction=0.0, **ELASTIC)
elastic_figure, panels = plt.subplots(1, 3, figsize=(11.5, 4.2), layout="constrained")
for ax, position in zip(panels, (0.0, 1e-3, 3e-3), strict=True):
    solution = elastic.solve(y=position, wheel_load=57e3, sides=("left",))
    solution.plot.section("y", ax=ax)
    ax.set_title(f"left wheel, y = {1e3 * position:g} mm, 57 kN")
    if position == 0.0:
        centred_solution = solution
patch = centred_solution.patches.iloc[0]
print(f"y = 0: semi-axes {1e3 * patch.semi_axis_x:.1f} mm along and {1e3 * patch.semi_axis_y:.1f} mm across")
assert patch.semi_axis_y > 2 * patch.semi_axis_x
centred_solution  # noqa: B018
