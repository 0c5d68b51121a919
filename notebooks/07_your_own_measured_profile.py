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
# # Measured profiles
#
# Profiles in service differ from the standards. `wr.profile` reads MiniProf (`.whl`, `.ban`), Simpack (`.prw`, `.prr`)
# and plain columns (`.txt`, `.csv`, `.dat`), converts them to one frame, checks them, and fits a smooth curve to the
# points. Contact depends on the second derivative of this curve, so even small measurement noise has to be removed.
# This notebook generates a worn wheel of known shape, adds measurement noise, and evaluates it up to the contact patch.
# Replace the generated file by a measured one.

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
SURFACE_SIZE, STRIPS, CELLS = 1e-3, 16, 10  # m, 1, 1; of the elastic contacts

# %% [markdown]
# ## A wheel after 150 000 km
#
# Wear removes the depth $w(y)$ from the new S1002 along its normal,
# $\mathbf x_\mathrm{worn} = \mathbf x - w(y)\,\mathbf n$, mostly on the running surface and less at the flange root:
#
# $$
# w(y) = 1.2\,\mathrm{mm}\; e^{-((y - 2\,\mathrm{mm}) / 30\,\mathrm{mm})^2} +
# 0.6\,\mathrm{mm}\; e^{-((y + 36\,\mathrm{mm}) / 6\,\mathrm{mm})^2}
# $$
#
# The measurement noise is 5 µm in both coordinates of points with a spacing of 0.2 mm, typical of a good instrument.
# The data are written as a MiniProf file: a header, an empty line, and columns in mm measured from the flange back.

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
    """MiniProf file, in mm from the flange back."""
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
# `noise` is the RMS distance of the curve from the points. With 0 the curve interpolates all points; with the accuracy
# of the instrument it is the smoothest curve compatible with the points. Second differences of 5 µm of noise over 0.2
# mm are $\sqrt 6 \cdot 5\,\mathrm{µm} / (0.2\,\mathrm{mm})^2 \approx 300\,\mathrm{m}^{-1}$: a hundred times the
# curvature of a rail head of 300 mm radius, with random sign. (Rounding of coordinates to 1 µm has a similar, smaller
# effect.)

# %%
truth = wr.profile(write(folder / "truth.whl", exact, digits=9))  # without noise and rounding
raw, worn = (wr.profile(measured, noise=noise) for noise in (0.0, NOISE))
s = np.linspace(-0.042, 0.03, 1500)
y = 1e3 * truth.point(s)[:, 0]
smoothing, (shape, curvature) = plt.subplots(2, 1, figsize=(7.4, 5.6), sharex=True, layout="constrained")
shape.plot(*(1e3 * new.point(new.samples(2e-4, -0.05, 0.035))).T, color=NEW, label="new S1002")
shape.plot(y, 1e3 * worn.point(s)[:, 1], color=WORN, ls="--", label="worn, as read")
shape.set(ylabel="height above the rolling circle [mm]", aspect="equal")
shape.legend()
for profile, label, style in (
    (raw, "through all points", {"color": ROUGH, "lw": 0.3}),
    (truth, "true shape", {"color": "0.2", "lw": 2.5, "alpha": 0.4}),
    (worn, "noise = 5 µm", {"color": WORN, "ls": "--"}),
):
    curvature.plot(y, profile.curvature(s), label=label, **style)
curvature.set(
    ylabel="curvature [1/m], convex: positive",
    xlabel="from the rolling circle to the field side [mm]",
    ylim=(-110, 110),
)
curvature.legend(ncols=3)
deviation = {
    name: float(np.abs(p.curvature(s) - truth.curvature(s)).mean()) for name, p in (("raw", raw), ("smooth", worn))
}
print({name: f"{value:.2f} 1/m" for name, value in deviation.items()})

# %% [markdown]
# The reader sets the height to zero on the rolling circle: a worn profile contains no information on the diameter,
# which is given by `radius`.
#
# ## Contact geometry
#
# The rigid contact positions and the rolling radius difference $\Delta r$ depend on the lateral position. A free
# wheelset with conical wheels of the angle $\gamma$ has a sinusoidal motion (Klingel); the equivalent conicity is that
# of cones with the same wavelength at a given amplitude (EN 15302).

# %%
lateral = np.linspace(-6e-3, 6e-3, PLACES)
geometry = {name: wr.contact_geometry(wheel, "UIC60", lateral) for name, wheel in (("new", new), ("worn", worn))}
styles = {"new": {"color": NEW}, "worn": {"color": WORN, "ls": "--"}}
rigid, axes = plt.subplots(1, 3, figsize=(9.4, 3.3), layout="constrained")
for name, data in geometry.items():
    axes[0].plot(1e3 * data.y, 1e3 * data.rolling_radius_difference, label=name, **styles[name])
    axes[1].plot(1e3 * data.y, 1e3 * data.wheel_y.sel(side="left"), ".", ms=3, color=styles[name]["color"], label=name)
    axes[2].plot(1e3 * data.amplitude, data.equivalent_conicity, label=name, **styles[name])
axes[0].set(xlabel="y of the wheelset, to the left [mm]", ylabel="rolling radius difference [mm]")
axes[1].set(
    xlabel="y of the wheelset, to the left [mm]",
    ylabel="contact on the left wheel, from\nthe rolling circle to the field side [mm]",
)
axes[2].set(xlabel="amplitude [mm]", ylabel="equivalent conicity")
axes[0].legend()

# %%
conicity = {name: float(data.equivalent_conicity.interp(amplitude=3e-3)) for name, data in geometry.items()}
print({name: round(value, 3) for name, value in conicity.items()}, "at 3 mm")

# %% [markdown]
# The contact on the new wheel jumps across a part of the tread near the centred position, and from tread to flange at 5
# mm. The worn wheel has no second jump, because its flange root has become part of a smooth curve, but twice the
# conicity. Its critical speed is lower.
#
# ## The patch
#
# 57 kN on each wheel, wheelset centred, elastic bodies. The conformal pressure of the new wheel extends over 20 mm. The
# hollow of the worn wheel has a larger curvature than the crown of a new rail, 5 per metre against 3.3: contact is on
# both sides of the hollow, with two patches, a smaller area and a higher pressure. A worn rail would give a different
# result.

# %%
resolution = {"surface_size": SURFACE_SIZE, "strips": STRIPS, "cells": CELLS}
contacts = {
    name: wr.Wheelset(wheel, "UIC60", friction=0.0, **resolution).solve(y=0.0, wheel_load=57e3, sides=["left"])
    for name, wheel in (("new", new), ("worn", worn))
}
pressures, axes = plt.subplots(1, 3, figsize=(10.4, 3.9), layout="constrained")
shown = [(name, k) for name, solution in contacts.items() for k in range(len(solution.patches))][:3]
for ax, (name, k) in zip(axes, shown, strict=False):
    patch = contacts[name].patches.iloc[k]
    contacts[name].plot.pressure("left", k, ax=ax)
    load = f"{1e-3 * patch.normal_force:.1f} kN on {1e6 * patch.area:.0f} mm²"
    ax.set_title(f"{name}, {1e3 * patch.wheel_y:.1f} mm from the\nrolling circle: {load}")
peak = {name: 1e-6 * float(solution.patches.max_pressure.max()) for name, solution in contacts.items()}
area = {name: 1e6 * float(solution.patches.area.sum()) for name, solution in contacts.items()}
for name in contacts:
    print(f"{name}: {peak[name]:.0f} MPa, {area[name]:.0f} mm2")

# %% [markdown]
# ## Other conventions, and rejected files
#
# Units, signs, separators and the origin are recognised, single points out of order are left out, and both are
# reported. A file that cannot be understood is rejected before any computation; the error names file, line, value and
# the allowed range.

# %%
columns = 1e3 * exact
swapped = columns.copy()
swapped[[300, 301]] = swapped[[301, 300]]
missing = columns.copy()
missing[300] = -9999.0
shuffled = np.random.default_rng(1).permutation(columns)
others = {"metres": 1e-3 * columns, "upside_down": columns * (1, -1), "swapped_lines": swapped}
invalid = {"missing": missing, "few": columns[:5], "shuffled": shuffled}
understood, rejected = {}, {}
for name, points in {**others, **invalid}.items():
    file = folder / f"{name}.csv"
    file.write_text("\n".join(f"{y:.6f}, {z:.6f}" for y, z in points))
    try:
        understood[name] = wr.profile(file, "wheel")
        print(f"{name}:", *understood[name].measurement.convention, *understood[name].measurement.remarks, sep=" | ")
    except ValueError as error:
        rejected[name] = str(error).replace(f"{folder}/", "")
        print(rejected[name])

# %%
assert rejected.keys() == invalid.keys()
assert understood.keys() == others.keys()
assert "line 301: y = -9999" in rejected["missing"]
assert deviation["smooth"] < 0.01 * deviation["raw"]
assert deviation["smooth"] < 1.5
assert np.abs(truth.closest(worn.point(s)).distance).max() < 10e-6
assert 0.15 < conicity["new"] < 0.20
assert 1.7 * conicity["new"] < conicity["worn"]
assert len(contacts["new"].patches) == 1
assert len(contacts["worn"].patches) == 2
assert peak["worn"] > 1.2 * peak["new"]
assert area["worn"] < 1.1 * area["new"]
