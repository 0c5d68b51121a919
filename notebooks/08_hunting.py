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
# # Hunting
#
# Above its critical speed a railway vehicle on straight track oscillates sideways between the rails: coned wheels steer
# a displaced wheelset back to the centre, and creep forces feed energy into this motion in proportion to the speed. The
# example is Manchester benchmark vehicle 1 in three dimensions, with S1002 wheels on 60E1 rails inclined at 1:40.
#
# Two contacts are compared: the standard contact of multibody codes (Kik-Piotrowski and FASTSIM), and elastic bodies.
# Their critical speeds differ by 11 m/s, for a reason that can be seen in the contact of the centred wheel.

# %%
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.strip_places import at_places
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.plots.style import SERIES, STYLE
from wheelrail.scenes.schema.scene import load_scene, parse_scene
from wheelrail.vehicle import Track, VehicleDynamics, equilibrium, simulate
from wheelrail.vehicle.simulation.limit_cycle import kicked
from wheelrail.vehicle.steady.critical_speed import critical_speed, least_damped, modes_over_speed

plt.rcParams.update(STYLE)
SCENES = Path("../scenes") if Path("../scenes").exists() else Path("scenes")

# %% tags=["parameters"]
SPEEDS = (50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0)  # m/s
SHIFTS = tuple(np.linspace(-1.0, 1.0, 21))  # mm
STRIPS, CELLS = 8, 10  # over the width of a patch, and along each
PLACES = 8  # of the strips on the wheel, over which the critical speed is averaged
BODIES = "waveguide"  # or "half-space"
DURATION = 3.0  # s

# %% [markdown]
# ## Vehicle and contacts
#
# The vehicle comes from a vehicle file, the contacts from scenes. Any contact serves all eight wheels.

# %%
text = (SCENES / "vehicle_elastic.toml").read_text(encoding="utf-8")
text = text.replace("strips = 8 ", f'bodies = "{BODIES}"\nstrips = {STRIPS} ').replace(
    "cells = 10 ", f"cells = {CELLS} "
)
contacts = {
    "standard": wheelset_contact(load_scene(SCENES / "hunting.toml")),
    "elastic": wheelset_contact(parse_scene(text, SCENES / "vehicle_elastic.toml")),
}
vehicle = load_vehicle(SCENES / "manchester_vehicle.toml")
dynamics = {name: VehicleDynamics(vehicle, Track(), contact, SPEEDS[0]) for name, contact in contacts.items()}
centred = {name: equilibrium(d) for name, d in dynamics.items()}

# %% [markdown]
# ## Linear stability
#
# At each speed the equations of motion are linearised about the equilibrium, the contact by its tangent. The vehicle is
# unstable where the real part of an eigenvalue is positive. Near the critical speed the least damped mode has the
# wheelsets of both bogies in lateral motion and yaw.

# %%
least = {name: [least_damped(modes) for modes in modes_over_speed(d, SPEEDS)] for name, d in dynamics.items()}
fig, ax = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
for (name, modes), style in zip(least.items(), SERIES, strict=False):
    ax.plot(SPEEDS, [mode.eigenvalue.real for mode in modes], label=name, **style)
ax.axhline(0.0, color="0.4", linewidth=0.8)
ax.set_xlabel("speed [m/s]")
ax.set_ylabel("growth rate [1/s]")
ax.legend()
growth = pd.DataFrame(
    {name: [mode.eigenvalue.real for mode in modes] for name, modes in least.items()},
    index=pd.Index(SPEEDS, name="m/s"),
)
growth.round(3)

# %% [markdown]
# ## Critical speeds
#
# The growth rate vanishes at the critical speed. With elastic bodies the slope of the force ripples with the place of
# the strips on the wheel: at 8 strips the steering moment by a lateral displacement has a standard deviation of 8 %,
# and the critical speed one of 2.3 m/s. The ripple has the period of a strip, so that the mean over places evenly
# spaced within a strip is that of narrower ones: 82.3, 82.2, 82.1 and 82.1 m/s from 8 places each of 8 x 10, 12 x 16,
# 16 x 20 and 24 x 20 strips and cells, with standard deviations of 2.3, 1.8, 1.1 and 0.5 m/s at a single place. Lines
# of the bodies' meshes from 0.5 to 1.4 mm apart change the mean by 0.1 m/s. The converged value is 82.1 m/s within 0.3
# m/s.


# %%
def critical_of(dynamics: VehicleDynamics) -> float:
    found = critical_speed(dynamics, (SPEEDS[0], SPEEDS[-1]))
    return np.nan if found is None else found.speed


by_place = {
    name: pd.Series([critical_of(replace(d, contact=contact)) for contact in at_places(d.contact, PLACES)])
    for name, d in dynamics.items()
}
critical = pd.DataFrame(by_place).agg(["mean", "sem", "min", "max"]).T  # m/s; sem: standard error of the mean
critical.round(2)

# %% [markdown]
# ## Why the contacts differ
#
# A centred S1002 wheel overlaps its 60E1 rail at 1:40 over a width of 20 mm, in two humps 10.6 mm apart. The standard
# contact and elastic bodies both carry the load in one patch, and its centre moves alike, by 6 mm for a millimetre of
# lateral displacement. This motion steers a nearly centred wheelset. How the load is spread within the patch steers it,
# too: virtual penetration gives the lower hump half of the load that elastic bodies put there, and hands the load over
# to it faster, so that longitudinal forces rise by 5.6 instead of 4.3 kN for a millimetre. Where a program takes
# the deepest point as the contact's place, its load turns back between 0.1 and 0.3 mm, and the critical speed is lower
# by another 6.7 m/s: compare critical speeds of programs with this figure beside them.


# %%
def load_centre(name: str, shift: float) -> float:
    """Lateral position, mm, of the load on the left wheel from the rolling circle, of a wheelset shifted by mm."""
    height = centred[name].state[dynamics[name].coordinates.index("wheelset_1", 2)]
    state = WheelsetState(y=1e-3 * shift, z=float(height), roll=0.0, pitch_rate=30.0 / 0.46, speed=30.0)
    patches = contacts[name](state, "left").patches
    return 1e3 * float(np.average([p.wheel_y for p in patches], weights=[p.normal_force for p in patches]))


centres = {name: [load_centre(name, shift) for shift in SHIFTS] for name in contacts}
fig, ax = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
for (name, values), style in zip(centres.items(), SERIES, strict=False):
    ax.plot(SHIFTS, values, label=name, **style)
ax.set_xlabel("lateral displacement of the wheelset [mm]")
ax.set_ylabel("centre of the load on the wheel [mm]")
ax.legend()

# %% [markdown]
# ## A motion after a kick
#
# 75 m/s with the standard contact, above its critical speed of 70.7 m/s: bogies are kicked sideways by 0.1 and 0.07
# m/s. The motion grows towards a limit cycle. Large ones from flange to flange need a stronger kick and a higher speed;
# `wheelrail hunting` follows them over descending speeds.

# %%
fast = replace(dynamics["standard"], speed=75.0)
start = kicked(fast.coordinates, equilibrium(fast).state, {"front_bogie": 0.1, "rear_bogie": 0.07})
run = simulate(fast, (0.0, DURATION), initial=start)
fig, ax = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
for wheelset, style in zip(("wheelset_1", "wheelset_2"), SERIES, strict=False):
    ax.plot(run.time, 1e3 * run.coordinate(wheelset, 1), label=wheelset, color=style["color"])
ax.set_xlabel("time [s]")
ax.set_ylabel("lateral displacement [mm]")
ax.legend()
print(run.status)
