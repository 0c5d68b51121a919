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
# # What bends
#
# A contact solve clamps the wheel at its bore and the rail along its foot. What the clamping leaves out moves the patch
# further than what the bodies do between: the axle bends under the wheel loads, so that each wheel leans by more than a
# milliradian, and the rail sinks into its pads and turns on them. `axle=True` and `pads=True` solve for these motions
# together with both contacts.

# %%
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline

import wheelrail as wr
from wheelrail.meshes.bodies.outlines import rail_outline, wheel_outline
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
PLACES = (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # mm, lateral displacement of the wheelset
RESOLUTION = {"strips": 16, "cells": 10}

# %% [markdown]
# ## Where the patch is
#
# The outer wheel of a wheelset under 57 kN on each wheel, without friction: places of all patches on the rail, mm, and
# their loads, kN. Half-spaces, the bodies of other contact codes, are beside.

# %%
LOAD = 57e3  # N
BODIES = {
    "half-spaces": {"bodies": "half-space"},
    "clamped": {},
    "axle": {"axle": True},
    "pads": {"pads": True},
    "axle and pads": {"axle": True, "pads": True},
}
solutions = {}
for name, options in BODIES.items():
    wheelset = wr.Wheelset(rail="UIC60-benchmark", friction=0.0, **RESOLUTION, **options)
    solutions[name] = [wheelset.solve(y=1e-3 * y, roll="solve", wheel_load=LOAD) for y in PLACES]


def patches(solution):
    """Place on the left rail, mm, and load, kN, of each patch of the left wheel."""
    return [(1e3 * patch.rail_y, 1e-3 * patch.normal_force) for patch in solution.results["left"].patches]


table = pd.DataFrame(
    {
        name: ["; ".join(f"{place:.2f} ({load:.1f})" for place, load in patches(solution)) for solution in column]
        for name, column in solutions.items()
    },
    index=pd.Index(PLACES, name="y [mm]"),
)
print(table.to_string())

# %%
figure, ax = plt.subplots(figsize=(8, 4.5), layout="constrained")
for offset, (name, column) in enumerate(solutions.items()):
    marks = [(y + 0.12 * (offset - 2), *mark) for y, s in zip(PLACES, column, strict=True) for mark in patches(s)]
    y, place, load = np.array(marks).T
    ax.scatter(y, place, load, label=name)
ax.set(xlabel="lateral displacement of the wheelset [mm]", ylabel="place on the left rail [mm]")
_ = ax.legend(title="area: load of the patch")

# %% [markdown]
# The bodies between the clamps move the patch by up to 0.75 mm against half-spaces, the axle by five. It delays the
# contact of the flange: at 5 mm the wheel is on the tread alone. Pads unload the flange where there are two contacts.
#
# ## What moves
#
# Motions of hubs and rails are part of the solution: those of the hubs relative to the line through the journals of the
# axle, those of the rails about the middle of the foot. At y = 2 mm:

# %%
flexible = wr.Wheelset(rail="UIC60-benchmark", friction=0.0, **RESOLUTION, axle=True, pads=True)
bent = flexible.solve(y=2e-3, wheel_load=LOAD).data
hub = {side: bent["hub_motion"].sel(side=side).values for side in ("left", "right")}
rail = {side: bent["rail_motion"].sel(side=side).values for side in ("left", "right")}
motions = pd.DataFrame(
    {
        side: [1e3 * hub[side][2], 1e3 * hub[side][3], 1e3 * rail[side][0], 1e3 * rail[side][1], 1e3 * rail[side][2]]
        for side in ("left", "right")
    },
    index=["hub: z [mm]", "hub: roll [mrad]", "rail: y [mm]", "rail: z [mm]", "rail: roll [mrad]"],
)
print(motions.round(3).to_string())

# %% [markdown]
# The wheelset and both rails, their motions magnified a hundred times. The axle bends upwards between the journals,
# which carry the vehicle, and the treads and flanges lean inwards.

# %%
SCALE = 100
mounting, (wheel_profile, rail_profile) = flexible.mounting, flexible.profiles
wheel, foot = wheel_outline(wheel_profile, mounting.radius), rail_outline(rail_profile)
section, rail_section = wheel.polygon(4e-3), foot.polygon(4e-3)
JOURNAL = 1.0  # m, from the middle of the axle


def moved(points, centre, shift, roll):
    """Points (n, 2) in y and z, turned about a centre and shifted, both magnified."""
    c, s = np.cos(SCALE * roll), np.sin(SCALE * roll)
    return (points - centre) @ [[c, s], [-s, c]] + centre + SCALE * np.asarray(shift)


def axle_line(end, z, slope):
    """Line (n, 2) of the axle from a hub to the journal, without bending moment at its end."""
    a = end - mounting.wheel_y
    y = np.linspace(0.0, a, 20)
    curvature = -3.0 * (z + slope * a) / a**2
    return np.column_stack([y + mounting.wheel_y, z + slope * y + curvature * (y**2 / 2 - y**3 / (6 * a))])


figure, ax = plt.subplots(figsize=(9, 6), layout="constrained")
for side, sign in (("left", 1.0), ("right", -1.0)):
    for factor, color in ((0.0, "0.8"), (1.0, "C0")):
        z, roll = factor * hub[side][2], factor * hub[side][3]
        centre = np.array([sign * mounting.wheel_y, mounting.radius])
        for half in (-1.0, 1.0):  # of the section, below and above the axle
            points = np.column_stack(
                [sign * (mounting.wheel_y + section[:, 0]), mounting.radius + half * section[:, 1]]
            )
            ax.fill(*moved(points, centre, (0.0, z), roll).T, fc="none", ec=color)
        points = np.column_stack([sign * (mounting.rail_y + rail_section[:, 0]), rail_section[:, 1]])
        bottom = np.array([sign * mounting.rail_y, rail_section[:, 1].min()])
        ax.fill(*moved(points, bottom, factor * rail[side][:2], factor * rail[side][2]).T, fc="none", ec=color)
        line = axle_line(JOURNAL, z, sign * roll)
        ax.plot(sign * line[:, 0], mounting.radius + SCALE * line[:, 1], color=color)
between = CubicHermiteSpline(
    [-mounting.wheel_y, mounting.wheel_y], [hub["right"][2], hub["left"][2]], [hub["right"][3], hub["left"][3]]
)
middle = np.linspace(-mounting.wheel_y, mounting.wheel_y, 60)
ax.plot(middle, mounting.radius + SCALE * between(middle), color="C0")
ax.set(aspect="equal", xlabel="y [m]", ylabel="z [m]")

# %% [markdown]
# ## Stress of the axle
#
# Between the wheels the axle bends as a beam in four-point bending: the wheel load, less the weight of wheels and axle
# that does not reach the journals, times their overhang of 0.25 m, and the lateral forces times the wheel's radius.

# %%
stress = bent["axle_stress"].sel(side="left") / 1e6
closed_form = -LOAD * (JOURNAL - mounting.wheel_y) / (np.pi / 32 * 0.160**3) / 1e6
figure, ax = plt.subplots(figsize=(7, 3.2), layout="constrained")
ax.plot(1e3 * bent["axle_y"], stress, label="with its weight and the lateral forces")
ax.axhline(closed_form, ls=":", color="0.5", label="57 kN times 0.25 m")
ax.set(xlabel="distance from the middle of the axle [mm]", ylabel="stress at the bottom [MPa]")
_ = ax.legend()

# %% [markdown]
# Runs take the same two bodies, as tables `[wheelset.axle]` and `[track.pads]` of the scene. The theory, with the whole
# curve of the paper, is in *Elastic axle and rails on pads* of the documentation.
