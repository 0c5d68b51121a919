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
# # Hertz, and how errors fall with the mesh
#
# A ball of $R = 0.3$ m is pressed on a flat block with $F = 10$ kN, both of steel. Hertz solved this in 1882, for
# half-spaces: with $1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2$,
#
# $$ a^3 = \frac{3FR}{4E^*}, \qquad p(r) = p_0\sqrt{1 - r^2/a^2}, \qquad p_0 = \frac{3F}{2\pi a^2}, \qquad
#    \delta = \frac{a^2}{R} . $$
#
# So every error of a computed contact can be seen. The finite elements are in the bodies' sections; along the rolling
# direction the bodies are endless and are treated wavenumber by wavenumber (notebook 03). The contact's unknowns are
# pressures on **fitted cells**: strips along the rolling direction that end where the contact ends.

# %%
import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
FITTED = (4, 6, 8, 12, 16, 24, 32)  # strips over the patch, and cells along each
GRIDS = (1.6e-3, 1.2e-3, 0.8e-3, 0.6e-3, 0.4e-3, 0.3e-3)  # m, edge of the cells of a regular grid
LOADS = (2e3, 5e3, 10e3, 20e3, 40e3)  # N
DEPTHS = tuple(np.arange(0.08, 2.01, 0.08))  # below the surface, over a

# %%
BALL, FLAT, LOAD, E, NU = (0.3, 0.3), (np.inf, np.inf), 10e3, 2.1e11, 0.3


def pair(**options):
    """Ball on block, without friction."""
    return wr.Hertz(BALL, FLAT, friction=0.0, E=E, nu=NU, **options)


exact = pair().closed_form(load=LOAD)
a = exact.semi_axes[0]
pressed = pair().solve(load=LOAD)
print(f"Hertz: {exact.peak / 1e6:.1f} MPa, radius {1e3 * a:.3f} mm, approach {1e6 * exact.approach:.2f} µm")
pressed  # noqa: B018

# %%
figure, panels = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained")
pressed.plot.pressure(ax=panels[0])
pressed.plot.section("y", ax=panels[1])
angle = np.linspace(0, 2 * np.pi, 200)
panels[0].plot(1e3 * a * np.cos(angle), 1e3 * a * np.sin(angle), color="#D55E00", lw=1.2)
panels[0].set_title("pressure of the default cells, and Hertz's circle")
panels[1].set_title("pressure across, one point for each strip")
peak = float(pressed.patches.max_pressure[0]) / exact.peak - 1
assert abs(peak) < 0.01

# %% [markdown]
# ## Order of convergence
#
# One number for the whole field: the error of the pressure in the mean square over the patch,
#
# $$ e = \lVert p - p_H \rVert_2 / \lVert p_H \rVert_2 . $$
#
# Hertz's pressure has an infinite slope at the edge. Cells that end there keep first order all the same; peak and area
# do better, for errors at the edge spoil them little. A regular grid sees the edge as a staircase: similar errors, but
# they scatter, and the area is off by whole cells.


# %%
def errors(solution):
    """Relative errors of pressure (RMS over the patch), peak and area."""
    own, patch = solution.data, solution.patches.iloc[0]
    known = exact.pressure(*own.position.values[:, :2].T)
    missed = np.average((own.pressure - known) ** 2, weights=own.area) / np.average(known**2, weights=own.area)
    return np.sqrt(missed), patch.max_pressure / exact.peak - 1, patch.area / (np.pi * a**2) - 1


fitted = np.array([errors(pair(strips=n, cells=n).solve(load=LOAD)) for n in FITTED])
grid = np.array([errors(pair(points="grid", surface_size=size).solve(load=LOAD)) for size in GRIDS])
across_fitted, across_grid = np.array(FITTED), 2 * a / np.array(GRIDS)
order = -slope(across_fitted, fitted[:, 0])

convergence_figure, panels = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained", sharey=True)
for ax, title, across, error in (
    (panels[0], "fitted cells", across_fitted, fitted),
    (panels[1], "regular grid", across_grid, grid),
):
    named = dict(zip(("pressure, RMS", "peak", "area"), error.T, strict=True))
    wr.plot_convergence(across, named, xlabel="cells across the patch [1]", ax=ax)
    ax.set(title=title, xticks=[4, 8, 16, 32])
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")
print(f"order of the pressure on fitted cells: {order:.2f}; on the grid: {-slope(across_grid, grid[:, 0]):.2f}")
assert 0.85 < order < 1.2

# %% [markdown]
# ## Without a closed form: the error estimate
#
# Real profiles have no closed form. `error_estimate=True` solves once more in the same place on half as many cells each
# way and tells the difference. Forces converge faster than pressures, nearly with second order, and the error of second
# order is a third of that difference: the estimate is on the safe side. Here it stands beside the true error at a fixed
# approach, against the finest solution at hand.

# %%
at = {"approach": exact.approach}
finest = pair(strips=40, cells=40).solve(**at).data.vertical_force.item()
estimated = {n: pair(strips=n, cells=n).solve(**at, error_estimate=True).data for n in FITTED if 8 <= n <= 24}
for n, own in estimated.items():
    force, estimate = own.vertical_force.item(), own.force_error.item()
    print(f"{n} x {n} cells: {force:.1f} N, off by {abs(force - finest):.1f} N, estimate {estimate:.1f} N")
assert all(abs(own.vertical_force.item() - finest) < own.force_error.item() for own in estimated.values())

# %% [markdown]
# ## Bodies end, half-spaces do not
#
# The pressure does not care, but the **approach** does: it is the path between far ends, and a block of half width and
# depth $D$, held at its bottom, lacks what lies below. Saint-Venant: far from the load that is the same for every
# contact of the same force, so each of the two blocks moves $\kappa F/(ED)$ less than a half-space, with one constant
# $\kappa$ for all loads. That is about one per cent of $\delta$: no reason to make blocks larger, but one to know what
# a code's "penetration" means before it becomes a spring in a multibody model. Here wheel and rail have their true
# size.

# %%
missing, kappa = [], []
for load in LOADS:
    own, closed = pair(strips=24, cells=24).solve(load=load), pair().closed_form(load=load)
    size = own.data.attrs["surface_size"]
    D = size * 2 ** np.ceil(np.log2(40 * closed.semi_axes[0] / size))  # the block that was meshed for this load
    gap = closed.approach - own.data.approach.item()
    missing.append(gap / closed.approach)
    kappa.append(gap * E * D / (2 * load))
print("missing [% of the approach]:", *np.round(100 * np.array(missing), 2))
print("kappa:", *np.round(kappa, 3))
assert np.ptp(kappa) < 0.05 * np.mean(kappa)

# %% [markdown]
# ## Stress below the surface
#
# On the axis of a circular contact (Johnson, Contact Mechanics, 1985, eq. 3.45), with $\zeta = z/a$,
#
# $$ \frac{\sigma_r}{p_0} = -(1+\nu)\left(1 - \zeta\arctan\frac1\zeta\right) + \frac{1}{2(1+\zeta^2)}, \qquad
#    \frac{\sigma_z}{p_0} = -\frac{1}{1+\zeta^2} . $$
#
# Largest shear is $\tau = |\sigma_z-\sigma_r|/2 = 0.31\,p_0$ at $0.48\,a$ below the surface, and von Mises' stress is
# twice that: yield, and the cracks of rolling contact fatigue, start inside (a line contact has $0.30\,p_0$ at
# $0.79\,a$).

# %%
zeta = np.array(DEPTHS)
under = pair().solve(load=LOAD, stress={"depths": zeta * a, "body": "lower"}).data.isel(side=0, body=0, patch=0)
sigma = under.stress.values / exact.peak
line = np.linspace(1e-3, zeta[-1], 400)
sigma_r = -(1 + NU) * (1 - line * np.arctan(1 / line)) + 0.5 / (1 + line**2)
sigma_z = -1 / (1 + line**2)
mises = under.von_mises.values / exact.peak

stress_figure, ax = plt.subplots(figsize=(5.4, 4.2), layout="constrained")
for curve, points, label, color in (
    (sigma_r, sigma[:, 0, 0], "along, $σ_x$", "#0072B2"),
    (sigma_z, sigma[:, 2, 2], "vertical, $σ_z$", "#009E73"),
    (abs(sigma_z - sigma_r), mises, "von Mises", "#D55E00"),
):
    ax.plot(curve, line, color=color)
    ax.plot(points, zeta, "o", ms=4, mfc="none", color=color, label=label)
ax.axhline(0.48, color="0.6", lw=0.8, ls=":")
ax.set(xlabel="stress / $p_0$ [1]", ylabel="depth / a [1]", ylim=(zeta[-1] * 1.02, 0))
ax.set_title("points: finite elements; lines: closed form")
ax.legend()
top = int(np.argmax(mises))
print(f"von Mises: at most {mises[top]:.3f} p0 at {zeta[top]:.2f} a")
assert abs(mises[top] - 0.62) < 0.01
assert 0.4 <= zeta[top] <= 0.56
