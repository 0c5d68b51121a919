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
# # Your own measured profile
#
# Profiles come from the track, not from standards. `wr.profile` reads MiniProf (`.whl`, `.ban`), Simpack (`.prw`,
# `.prr`) and plain columns (`.txt`, `.csv`, `.dat`), turns them to one frame, checks them, and lays a smooth curve
# through the points. Contact sees the second derivative of that curve, so a measurement that looks perfect on paper
# may be useless until its noise is taken out. This notebook makes a worn wheel whose true shape is known, measures it
# with noise, and follows it to the contact patch. Put your own file in its place.

# %%
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from wheelrail.scenes.plots.style import SERIES, STYLE

plt.rcParams.update(STYLE)
NEW, WORN, ROUGH = SERIES[0]["color"], SERIES[1]["color"], "0.75"

# %% tags=["parameters"]
PLACES = 121  # lateral positions of the contact geometry, from -6 to 6 mm
SURFACE_SIZE, STRIPS, CELLS = 1e-3, 12, 16  # m; of the contact

# %% [markdown]
# ## A wheel after 150 000 km
#
# Wear takes depth off the new S1002 along its normal, $\mathbf x_\mathrm{worn} = \mathbf x - w(y)\,\mathbf n$, most
# where the wheel runs and some at the flange root:
#
# $$
# w(y) = 1.2\,\mathrm{mm}\; e^{-((y - 2\,\mathrm{mm}) / 30\,\mathrm{mm})^2} +
# 0.6\,\mathrm{mm}\; e^{-((y + 36\,\mathrm{mm}) / 6\,\mathrm{mm})^2}
# $$
#
# The instrument adds 5 µm of noise to both coordinates of points 0.2 mm apart: a good one. What it writes is a MiniProf
# file: a header, an empty line, and columns of lengths in mm counted from the back of the flange.

# %%
new = wr.profile("S1002")
NOISE = 5e-6  # m


def worn_points(profile, spacing):
    """Points (n, 2) m of the worn wheel."""
    s = profile.samples(spacing, profile.s_at_y(-69.5e-3), profile.s_at_y(59.5e-3))
    points = profile.point(s)
    y = points[:, 0]
    tread, root = np.exp(-(((y - 2e-3) / 30e-3) ** 2)), np.exp(-(((y + 36e-3) / 6e-3) ** 2))
    return points - (1.2e-3 * tread + 0.6e-3 * root)[:, None] * profile.normal(s)


def write(file, points, digits=4):
    """MiniProf's way: mm from the flange's back."""
    lines = [f"{1e3 * y + 70:.{digits}f} {1e3 * z:.{digits}f}" for y, z in points]
    file.write_text("ProgramName=MiniProf\nColumnDef=X,Y\n\n" + "\n".join(lines))
    return file


folder = Path(TemporaryDirectory(prefix="wheelrail-").name)
folder.mkdir()
exact = worn_points(new, 2e-4)
measured = write(folder / "wheel_17_left.whl", exact + np.random.default_rng(17).normal(0.0, NOISE, exact.shape))
print("\n".join(measured.read_text().splitlines()[:6]))

# %% [markdown]
# ## Smoothing
#
# `noise` is the RMS distance that the curve may keep from the points. With 0 it passes through all of them; given what
# the instrument's data sheet says, it is the smoothest curve that the points allow. Second differences of 5 µm of
# noise over 0.2 mm are $\sqrt 6 \cdot 5\,\mathrm{µm} / (0.2\,\mathrm{mm})^2 \approx 300\,\mathrm{m}^{-1}$: a hundred
# times the curvature of a rail head's 300 mm, and of either sign. (Coordinates rounded to 1 µm do the same on a
# smaller scale.)

# %%
truth = wr.profile(write(folder / "truth.whl", exact, digits=9))  # without noise, or rounding
raw, worn = (wr.profile(measured, noise=noise) for noise in (0.0, NOISE))
s = np.linspace(-0.042, 0.03, 1500)
y = 1e3 * truth.point(s)[:, 0]
smoothing, (shape, bend) = plt.subplots(2, 1, figsize=(7.4, 5.6), sharex=True, layout="constrained")
shape.plot(*(1e3 * new.point(new.samples(2e-4, -0.05, 0.035))).T, color=NEW, label="new S1002")
shape.plot(y, 1e3 * worn.point(s)[:, 1], color=WORN, ls="--", label="worn, as read")
shape.set(ylabel="height over the rolling circle [mm]", aspect="equal")
shape.legend()
for profile, label, look in (
    (raw, "through all points", {"color": ROUGH, "lw": 0.3}),
    (truth, "true shape", {"color": "0.2", "lw": 2.5, "alpha": 0.4}),
    (worn, "noise = 5 µm", {"color": WORN, "ls": "--"}),
):
    bend.plot(y, profile.curvature(s), label=label, **look)
bend.set(
    ylabel="curvature [1/m], convex: positive",
    xlabel="from the rolling circle to the field side [mm]",
    ylim=(-110, 110),
)
bend.legend(ncols=3)
off = {name: float(np.abs(p.curvature(s) - truth.curvature(s)).mean()) for name, p in (("raw", raw), ("smooth", worn))}
print({name: f"{value:.2f} 1/m" for name, value in off.items()})

# %% [markdown]
# The reader sets the height to zero on the rolling circle: a worn profile tells nothing of the diameter, which goes in
# as `radius`.
#
# ## Contact geometry
#
# Where do rigid profiles touch, and how fast does the difference of the rolling radii, $\Delta r$, grow with the
# lateral position? A free wheelset on cones of the angle $\gamma$ runs in waves (Klingel); the equivalent conicity is
# that of cones with waves as long as the wheelset's own, for an amplitude (EN 15302).

# %%
at = np.linspace(-6e-3, 6e-3, PLACES)
geometry = {name: wr.contact_geometry(wheel, "UIC60", at) for name, wheel in (("new", new), ("worn", worn))}
looks = {"new": {"color": NEW}, "worn": {"color": WORN, "ls": "--"}}
rigid, axes = plt.subplots(1, 3, figsize=(9.4, 3.3), layout="constrained")
for name, found in geometry.items():
    axes[0].plot(1e3 * found.y, 1e3 * found.rolling_radius_difference, label=name, **looks[name])
    axes[1].plot(1e3 * found.y, 1e3 * found.wheel_y.sel(side="left"), ".", ms=3, color=looks[name]["color"], label=name)
    axes[2].plot(1e3 * found.amplitude, found.equivalent_conicity, label=name, **looks[name])
axes[0].set(xlabel="wheelset to the left [mm]", ylabel="difference of rolling radii [mm]")
axes[1].set(
    xlabel="wheelset to the left [mm]",
    ylabel="contact on the left wheel, from\nthe rolling circle to the field side [mm]",
)
axes[2].set(xlabel="amplitude [mm]", ylabel="equivalent conicity")
axes[0].legend()

# %%
conicity = {name: float(found.equivalent_conicity.interp(amplitude=3e-3)) for name, found in geometry.items()}
print({name: round(value, 3) for name, value in conicity.items()}, "at 3 mm")

# %% [markdown]
# The new wheel leaps over a part of its tread as it passes the centre, and from tread to flange at 5 mm. The worn one
# has lost the second leap, its flange root having become part of a continuous curve, at the price of twice the
# conicity. It will run unstable at a lower speed.
#
# ## The patch
#
# 57 kN on each wheel, centred, elastic bodies. Conformity spreads the pressure of the new wheel over 20 mm. The hollow
# of the worn one is more curved than the crown of a new rail, 5 per metre against 3.3: it cannot rest in its middle and
# rides on both edges, with two patches and more pressure on less area. On a rail that has worn along with it this
# would be otherwise: read one, and see.

# %%
fineness = {"surface_size": SURFACE_SIZE, "strips": STRIPS, "cells": CELLS}
contacts = {
    name: wr.Wheelset(wheel, "UIC60", friction=0.0, **fineness).solve(y=0.0, wheel_load=57e3, sides=["left"])
    for name, wheel in (("new", new), ("worn", worn))
}
pressures, axes = plt.subplots(1, 3, figsize=(10.4, 3.9), layout="constrained")
shown = [(name, k) for name, found in contacts.items() for k in range(len(found.patches))][:3]
for ax, (name, k) in zip(axes, shown, strict=False):
    patch = contacts[name].patches.iloc[k]
    contacts[name].plot.pressure("left", k, ax=ax)
    carries = f"{1e-3 * patch.normal_force:.1f} kN on {1e6 * patch.area:.0f} mm²"
    ax.set_title(f"{name}, {1e3 * patch.wheel_y:.1f} mm from the\nrolling circle: {carries}")
peak = {name: 1e-6 * float(found.patches.max_pressure.max()) for name, found in contacts.items()}
area = {name: 1e6 * float(found.patches.area.sum()) for name, found in contacts.items()}
for name in contacts:
    print(f"{name}: {peak[name]:.0f} MPa, {area[name]:.0f} mm2")

# %% [markdown]
# ## What the reader refuses
#
# Most trouble with profiles is a unit or a sign. A file that cannot be what it says is refused, with its name, the
# line, the value and what is allowed, before anything is computed.

# %%
columns = 1e3 * exact
swapped = columns.copy()
swapped[[300, 301]] = swapped[[301, 300]]
spoiled = {"metres": 1e-3 * columns, "mirrored": columns * (-1, 1), "upside_down": columns * (1, -1)}
spoiled |= {"swapped_lines": swapped, "few": columns[:5], "not_a_number": np.where(columns > 59.0, np.nan, columns)}
refused = {}
for name, points in spoiled.items():
    file = folder / f"{name}.csv"
    file.write_text("\n".join(f"{y:.6f}, {z:.6f}" for y, z in points))
    try:
        wr.profile(file, "wheel")
    except ValueError as error:
        refused[name] = str(error).replace(f"{folder}/", "")
        print(refused[name])

# %%
assert refused.keys() == spoiled.keys()
assert "look like metres" in refused["metres"]
assert "flange lies at positive y" in refused["mirrored"]
assert off["smooth"] < 0.01 * off["raw"]
assert off["smooth"] < 1.5
assert np.abs(truth.closest(worn.point(s)).distance).max() < 10e-6
assert 0.15 < conicity["new"] < 0.20
assert 1.7 * conicity["new"] < conicity["worn"]
assert len(contacts["new"].patches) == 1
assert len(contacts["worn"].patches) == 2
assert peak["worn"] > 1.2 * peak["new"]
assert area["worn"] < 1.1 * area["new"]
