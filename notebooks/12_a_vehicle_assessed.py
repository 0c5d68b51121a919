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
# # A vehicle assessed
#
# The Manchester benchmark vehicle on irregular rails through three curves: forces and accelerations over their limits,
# comfort of a passenger, and what of the vehicle moves these numbers.
#
# Limits of which no public source was found are marked *not confirmed* and drawn hollow: a verdict here is an
# engineer's estimate and no acceptance.

# %%
import tomllib
from importlib.resources import files
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import pandas as pd

import wheelrail as wr
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)
SCENES = files("wheelrail.scenes") / "examples"
FOLDER = Path(mkdtemp(prefix="assessed-"))

# %% tags=["parameters"]
CURVES = {700.0: (0.10, 32.0), 500.0: (0.10, 27.0), 300.0: (0.12, 22.0)}  # R, m: cant, m, and speed, m/s
TANGENT, TRANSITION, LENGTH = 60.0, 80.0, 700.0  # m, the last of full curve
SEEDS = (1,)  # of the irregularities
PARAMETERS = {
    "vehicle.elements.primary.stiffness.1": {"low": 2e6, "high": 6e6},  # N/m, across
    "vehicle.bodies.car_body.mass": {"low": 25e3, "high": 45e3},  # kg
    "friction": {"low": 0.15, "high": 0.45},
}

# %% [markdown]
# ## Runs
#
# One run for each curve and realisation of the rails. Contact is `standard`, which takes about a second a run;
# `vehicle_table.toml` has elastic contact in a table for the same purpose.


# %%
def run(radius, cant, speed, seed):
    """A run into a curve, stored in a folder of its own."""
    segments = [
        {"kind": "tangent", "length": TANGENT},
        {"kind": "transition", "length": TRANSITION, "curvature": 1.0 / radius, "cant": cant},
        {"kind": "arc", "length": LENGTH, "curvature": 1.0 / radius, "cant": cant},
    ]
    return wr.run(
        SCENES / "vehicle_irregular.toml",
        FOLDER / f"R{radius:.0f}_{seed}",
        vehicle=SCENES / "manchester_vehicle.toml",
        **{
            "track.segments": segments,
            "track.irregularities.seed": seed,
            "vehicle.speed": speed,
            "output.interval": 0.005,
            "output.figures": False,
        },
    )


runs = {
    f"R{radius:.0f}_{seed}": run(radius, cant, speed, seed)
    for radius, (cant, speed) in CURVES.items()
    for seed in SEEDS
}
pd.DataFrame(
    {
        "status": [one.status for one in runs.values()],
        "largest Q [kN]": [1e-3 * float(one.data["vertical_force"].max()) for one in runs.values()],
    },
    index=list(runs),
).round(1)

# %% [markdown]
# ## Assessed
#
# Sections of constant curvature get percentiles of filtered signals, zones get estimates from their sections, and each
# estimate stands beside its limit and the source of that.

# %%
found = wr.assess([FOLDER / name for name in runs])
print(found)

# %%
found.plot()

# %% [markdown]
# The sharpest curve along the track: sections are shaded.

# %%
found.plot_run(len(runs) - 1)

# %% [markdown]
# ## What moves the result
#
# Each parameter alone at both ends, in the steady sharpest curve: a tornado. The mass of the body and friction move the
# guiding force by a fifth, the primary spring across hardly.

# %%
radius = min(CURVES)
scene = tomllib.loads((SCENES / "vehicle.toml").read_text())
scene["track"] |= {"curvature": 1.0 / radius, "cant": CURVES[radius][0]}
scene["vehicle"]["speed"] = CURVES[radius][1]
study = wr.study(
    {
        "kind": "study",
        "scene": scene,
        "vehicle": str(SCENES / "manchester_vehicle.toml"),
        "compute": "curving",
        "one_at_a_time": PARAMETERS,
    }
)
print(study)
study.plot()
