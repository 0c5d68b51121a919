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
# # Profiles, and where they touch
#
# Before any force there is geometry: two curves, the wheel's profile and the rail's, and a wheelset that may stand a
# few millimetres to the left or right. Where the curves touch sets the rolling radii, and their difference steers the
# wheelset. Here both bodies are rigid; from notebook 02 on they are elastic, and the geometry says what to expect.
#
# Lengths in m, $x$ forward, $y$ to the left, $z$ up. On a profile $y$ counts to the field side and $s$ is the arc
# length along it, from the rolling circle of the wheel or the top of the rail.

# %%
import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import wheelrail as wr
from wheelrail.scenes.plots.style import SERIES, SIDES, STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
POSITIONS = 321  # of the wheelset, from 8 mm on the right to 8 mm on the left
ELASTIC = {"surface_size": 1e-3, "strips": 12, "cells": 16}  # of the contact at the end

# %% [markdown]
# ## Two curves
#
# 60E1, once UIC60 (EN 13674), is drawn from arcs, so its curvature jumps in the middle of the running band, and with it
# all that depends on it. S1002 (EN 13715) has polynomials on the tread between the arcs of the flange and a straight
# outer part. Convex counts positive. In the throat, where the tread meets the flange of 70 degrees, the wheel is hollow
# with a radius of 13 mm: there curvature is negative, and the gauge corner of the rail, 13 mm too, all but fits in.

# %%
wheel, rail = wr.profile("S1002"), wr.profile("60E1")
profile_figure, panels = plt.subplots(2, 2, figsize=(10, 4.8), layout="constrained", sharex="col")
for (outline, bend), profile in zip(panels.T, (wheel, rail), strict=True):
    s = profile.samples(5e-5)
    y, z = 1e3 * profile.point(s).T
    outline.plot(y, z, color=SERIES[0]["color"])
    outline.set(title=f"{profile.kind} {profile.name}", xlabel="y, to the field side [mm]")
    outline.set_ylabel("from the axle outward [mm]" if profile is wheel else "z, up [mm]")
    outline.set_aspect("equal", adjustable="datalim")
    bend.plot(y, profile.curvature(s), color=SERIES[1]["color"])
    bend.set(xlabel="y, to the field side [mm]", ylabel="curvature [1/m]")
throat = float(wheel.curvature(-0.041))
steepest = np.degrees(np.arctan2(*-wheel.tangent(-0.0443)[::-1]) % np.pi)
flange = 180 - steepest if steepest > 90 else steepest
tread = wheel.tangent(0.045)
print(f"throat: {1e3 / throat:.2f} mm; flange: {flange:.1f} degrees; outer tread falls 1 in {-tread[0] / tread[1]:.2f}")
assert abs(1 / throat + 0.013) < 1e-5
assert abs(flange - 70) < 0.1
assert abs(-tread[0] / tread[1] - 15) < 0.05

# %% [markdown]
# ## Where they touch
#
# `contact_geometry` lowers the rigid wheelset on two rails, laid at 1 in 40 with a gauge of 1435 mm, until both wheels
# touch; roll follows from that. **The contact jumps**: where the wheel is more hollow than the rail is round, the rail
# cannot reach in, and the contact leaps across. Left of the first leap, at 0.2 mm, runs the tread; from 5 mm on the
# throat; from 6 mm on the flange.

# %%
y = np.linspace(-8e-3, 8e-3, POSITIONS)
touch = wr.contact_geometry(wheel, rail, y)
left = touch.sel(side="left")

pair_figure, panels = plt.subplots(1, 2, figsize=(11, 2.4), layout="constrained")
for ax, place in zip(panels, (0.0, 6e-3), strict=True):
    wr.plot_profiles(wheel, rail, y=place, ax=ax)
    ax.set_title(f"left wheel, wheelset {1e3 * place:g} mm to the left")
    ax.set(xlim=(-45, 45), ylim=(-20, 12))

# %%
place_figure, panels = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained", sharex=True)
for side in ("left", "right"):
    own = touch.sel(side=side)
    panels[0].plot(1e3 * y, 1e3 * own.rail_y, ".", ms=3, color=SIDES[side]["color"], label=f"{side} rail")
    panels[1].plot(1e3 * y, 1e3 * own.wheel_y, ".", ms=3, color=SIDES[side]["color"], label=f"{side} wheel")
panels[0].set(ylabel="contact on the rail, y to the field side [mm]")
panels[1].set(ylabel="contact on the wheel, y to the field side [mm]")
for ax in panels:
    ax.set_xlabel("wheelset's lateral position, to the left [mm]")
    ax.legend()
jumps = np.abs(np.diff(left.wheel_y))
centre = jumps[np.abs(y[:-1]) < 1e-3].max()
print(f"on the wheel the left contact jumps by {1e3 * centre:.1f} mm next to y = 0, {1e3 * jumps.max():.1f} mm at most")
assert centre > 8e-3

# %% [markdown]
# ## Rolling radii and equivalent conicity
#
# With its left wheel on a larger radius $r_l$ than the right one $r_r$, a free wheelset turns to the right, towards the
# track's centre. To first order in yaw and displacement that is
#
# $$ \frac{d^2 y}{dx^2} + \frac{\Delta r(y)}{e\,r_0} = 0, \qquad \Delta r = r_l - r_r , $$
#
# with $e$ between the rolling circles. For cones $\Delta r = 2\lambda y$, and the solution is Klingel's sine of length
# $L = 2\pi\sqrt{e\,r_0/2\lambda}$. For any other profiles the **equivalent conicity** $\lambda$ at an amplitude is that
# of the cones that would give waves of the same length (EN 15302). As a check we integrate the motion itself.

# %%
e, r0 = touch.attrs["base"], touch.attrs["nominal_radius"]
amplitude = 3e-3
conicity = float(np.interp(amplitude, touch.amplitude, touch.equivalent_conicity))
klingel = 2 * np.pi * np.sqrt(e * r0 / (2 * conicity))


def steered(x, state):
    """Kinematic motion: y and dy/dx."""
    return state[1], -np.interp(state[0], y, touch.rolling_radius_difference) / (e * r0)


def centred(x, state):
    return state[0]


wave = solve_ivp(steered, (0, 12), (amplitude, 0.0), events=centred, max_step=0.02, rtol=1e-8, atol=1e-10)
half = float(np.diff(wave.t_events[0])[0])
print(f"conicity {conicity:.4f} at 3 mm; Klingel's wavelength {klingel:.3f} m, integrated {2 * half:.3f} m")

steering_figure, panels = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained")
panels[0].plot(1e3 * y, 1e3 * touch.rolling_radius_difference, color=SERIES[0]["color"])
panels[0].set(xlabel="wheelset's lateral position, to the left [mm]", ylabel="rolling radius, left less right [mm]")
panels[1].plot(1e3 * touch.amplitude, touch.equivalent_conicity, color=SERIES[0]["color"])
panels[1].plot(1e3 * amplitude, conicity, "o", color=SERIES[1]["color"], label=f"{conicity:.3f} at 3 mm")
panels[1].set(xlabel="amplitude [mm]", ylabel="equivalent conicity [1]", ylim=(0, 0.7))
panels[1].legend()
panels[2].plot(wave.t, 1e3 * wave.y[0], color=SERIES[0]["color"], label="integrated")
sine = 1e3 * amplitude * np.cos(2 * np.pi * wave.t / klingel)
panels[2].plot(wave.t, sine, color=SERIES[1]["color"], ls="--", label="cones alike (Klingel)")
panels[2].set(xlabel="path along the track [m]", ylabel="y of the wheelset, to the left [mm]")
panels[2].legend()
at_3 = float(np.interp(3e-3, y, touch.rolling_radius_difference))
assert abs(at_3 - 0.96e-3) < 0.02e-3
assert abs(conicity - 0.178) < 0.005  # S1002 on UIC60 1:40, gauge 1435 mm
assert abs(2 * half / klingel - 1) < 0.01
assert np.allclose(touch.rolling_radius_difference, -touch.rolling_radius_difference[::-1], atol=1e-9)

# %% [markdown]
# ## Two contacts at once
#
# Where the rigid contact jumps, both places touch at once. For rigid bodies that is a single position and a table of
# $\Delta r$ steps there. Elastic bodies give way: under load the second place closes before the first one opens, and
# over a stretch of $y$ both carry. S1002 on 60E1 does so with the wheelset centred, where it spends most of its life:
# at $y = 0$ one patch, 18 mm wide, has two summits. Dashed is what Hertz would make of the curvatures in its middle:
# 505 MPa, where 780 MPa act. At 3 mm the contact is nearly an ellipse, and he is right.

# %%
elastic = wr.Wheelset(wheel, rail, friction=0.0, **ELASTIC)
near_figure, panels = plt.subplots(1, 3, figsize=(11.5, 4.2), layout="constrained")
for ax, place in zip(panels, (0.0, 1e-3, 3e-3), strict=True):
    found = elastic.solve(y=place, wheel_load=57e3, sides=("left",))
    found.plot.section("y", ax=ax)
    ax.set_title(f"left wheel, y = {1e3 * place:g} mm, 57 kN")
    if place == 0.0:
        centred_solution = found
patch = centred_solution.patches.iloc[0]
print(f"y = 0: semi-axes {1e3 * patch.semi_axis_x:.1f} mm along and {1e3 * patch.semi_axis_y:.1f} mm across")
assert patch.semi_axis_y > 2 * patch.semi_axis_x
centred_solution  # noqa: B018
