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
# # A wheel's life
#
# Wear changes profiles, profiles change contacts, and contacts change wear. A *duty* says where a vehicle runs, a *law*
# how much material a contact removes; `wr.wear` solves the duty, removes a small depth, and repeats. The wheel is S1002
# under the Manchester benchmark vehicle, the law that of Sheffield's twin discs, and contacts are elastic.
#
# Absolute rates need calibration: laboratory laws differ by a factor of ten, and here `scale` stands for lubrication.

# %%
from importlib.resources import files

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import wheelrail as wr
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)
SCENES = files("wheelrail.scenes") / "examples"

# %% tags=["parameters"]
UNTIL, DEPTH = 5e6, 1e-4  # m: distance, and largest depth of a step
CHANGES = {}  # of the scene: 8 strips, 10 cells, finite bodies
PLACES = (0.0, 2.0, 4.0, 6.0)  # mm
FRICTION = [0.2, 0.3, 0.4]

# %% [markdown]
# ## The duty
#
# Three curves with shares of the distance. `both_hands` counts curves to the right as often as those to the left;
# all wheels share one profile.

# %%
CURVES = {8000.0: (0.4, 0.0, 45.0), 1200.0: (0.4, 0.06, 35.0), 600.0: (0.2, 0.10, 25.0)}  # R, m: share, cant, speed


def table(until, **changes):
    """Wear file as a dict; changes: of the cases."""
    duty = [
        {
            "share": share,
            "steady": {"curvature": 1.0 / radius, "cant": cant, "speed": speed},
            "both_hands": True,
            "set": CHANGES,
            **changes,
        }
        for radius, (share, cant, speed) in CURVES.items()
    ]
    return {
        "scene": str(SCENES / "vehicle_elastic.toml"),
        "vehicle": str(SCENES / "manchester_vehicle.toml"),
        "law": {"name": "usfd", "scale": 0.18},
        "until": until,
        "depth": DEPTH,
        "duty": duty,
    }


worn = wr.wear(table(UNTIL))
print(worn)

# %% [markdown]
# The column *error* is half the change of the rates over a step: what a step errs by. Depths that matter need a second
# calculation with half of `depth`.

# %%
worn.plot.profiles(scale=20)
worn.plot.measures()
# %% [markdown]
# ## Where it wears
#
# Rates along the profile, new and at the end: curves wear the flange root and the gauge side of the tread. R = 600 m is
# a fifth of the distance and half of the wear, R = 8000 m two fifths and a twentieth.

# %%
worn.plot.duty()
section = worn.data["depth_rate"].isel(profile=0).sum("s") * float(np.diff(worn.data["s"]).mean())
rates = section.isel(step=[0, -2]) * worn.data["share"] * 1e13  # mm² in 10 000 km
pd.DataFrame(rates.values, ["new", "worn"], [f"R {radius:.0f} m" for radius in CURVES]).round(2)

# %% [markdown]
# ## Fatigue
#
# Damage by $T\gamma$ grows where wear is too small to remove cracks: it is shown beside wear, never added to it.

# %%
worn.plot.fatigue()
# %% [markdown]
# ## The worn wheel in contact
#
# `worn.profile` is a profile as any other: largest pressures, MPa, of a wheelset under 57 kN a wheel by its lateral
# displacement. The new flange root bears 2.8 GPa at 6 mm, the worn one less than half; at 4 mm the worn wheel bears
# more.

# %%
new = wr.profile("S1002")
wheels = {"new": new, "worn": worn.profile(new)}
own = {key: value for key, value in CHANGES.items() if key in ("bodies", "strips", "cells")}
peaks = pd.DataFrame(index=pd.Index(PLACES, name="y [mm]"), columns=list(wheels), dtype=float)
for name, wheel in wheels.items():
    wheelset = wr.Wheelset(wheel=wheel, rail="60E1", friction=0.0, **own)
    for y in PLACES:
        solution = wheelset.solve(y=1e-3 * y, roll="solve", wheel_load=57e3)
        peaks.loc[y, name] = 1e-6 * float(solution.data["patch_max_pressure"].max())
peaks.round(0)

# %% [markdown]
# ## Friction
#
# Friction is never one number. `vary` makes cases of a list, here of the first step alone.

# %%
first = wr.wear(table(1.0, vary={"friction": FRICTION})).data
by_case = first["t_gamma"].isel(step=0).values.reshape(len(CURVES), len(FRICTION))
pd.DataFrame(by_case, [f"R {radius:.0f} m" for radius in CURVES], [f"friction {mu:g}" for mu in FRICTION]).round(1)

# %% [markdown]
# $T\gamma$ in N, mean of all wheels. In sharp curves creepages are given by the geometry and energy grows with
# friction; in wide ones wheelsets steer, and it hardly does.
#
# ## How far
#
# Straight on at the last rate, the removed section reaches that of a wheel 2 mm smaller at:

# %%
data = worn.data
distance, removed = (data[name].values.squeeze() for name in ("distance", "removed_section"))
rate = (removed[-1] - removed[-2]) / (distance[-1] - distance[-2])
tread = 2e-3 * 70e-3  # m2
print(f"{1e-3 * (distance[-1] + (tread - removed[-1]) / rate):.0f} km")

# %% [markdown]
# An extrapolation by a factor of thirty is no prediction: `until` costs seconds a step, and a duty of one vehicle
# needs irregular track and worn rails, too. `reprofile = {"Sd": 26e-3}` turns wheels on the way; `rails` wears rails.
