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
# # Hertz contact and mesh convergence
#
# A sphere of $R = 0.3$ m is pressed onto a flat block with $F = 10$ kN; both are of steel. Hertz's solution (1882) for
# half-spaces is, with $1/E^* = (1-\nu_1^2)/E_1 + (1-\nu_2^2)/E_2$,
#
# $$ a^3 = \frac{3FR}{4E^*}, \qquad p(r) = p_0\sqrt{1 - r^2/a^2}, \qquad p_0 = \frac{3F}{2\pi a^2}, \qquad
#    \delta = \frac{a^2}{R} . $$
#
# It allows all errors of a computed contact to be measured. Finite elements discretise the cross-sections of the
# bodies; along the rolling direction the bodies are infinitely long and are solved by wavenumber (notebook 03). The
# unknowns of the contact are pressures on **cells of strips**: strips along the rolling direction that end at the patch
# edge.

# %%
import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr
from wheelrail.scenes.plots.fits import slope
from wheelrail.scenes.plots.style import STYLE

plt.rcParams.update(STYLE)

# %% tags=["parameters"]
STRIPS = (6, 8, 11, 16, 22, 32)  # strips over the patch, and cells along each
GRIDS = (1.6e-3, 1.2e-3, 0.8e-3, 0.6e-3, 0.4e-3, 0.3e-3)  # m, edge of the cells of a regular grid
LOADS = (2e3, 5e3, 10e3, 20e3, 40e3)  # N
DEPTHS = tuple(np.arange(0.08, 2.01, 0.08))  # depth below the surface / a

# %%
SPHERE, FLAT, LOAD, E, NU = (0.3, 0.3), (np.inf, np.inf), 10e3, 2.1e11, 0.3


def pair(**options):
    """Sphere on a block, frictionless."""
    return wr.Hertz(SPHERE, FLAT, friction=0.0, E=E, nu=NU, **options)


exact = pair().closed_form(load=LOAD)
a = exact.semi_axes[0]
solution = pair().solve(load=LOAD)
print(f"Hertz: {exact.peak / 1e6:.1f} MPa, radius {1e3 * a:.3f} mm, approach {1e6 * exact.approach:.2f} µm")
solution  # noqa: B018

# %%
figure, panels = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained")
solution.plot.pressure(ax=panels[0])
solution.plot.section("y", ax=panels[1])
angle = np.linspace(0, 2 * np.pi, 200)
panels[0].plot(1e3 * a * np.cos(angle), 1e3 * a * np.sin(angle), color="#D55E00", lw=1.2)
panels[0].set_title("pressure on the default cells, and Hertz's circle")
panels[1].set_title("lateral section, one point per strip")
peak = float(solution.patches.max_pressure[0]) / exact.peak - 1
assert abs(peak) < 0.01

# %% [markdown]
# ## Order of convergence
#
# The error of the pressure field is measured in the $L^2$ norm over the patch,
#
# $$ e = \lVert p - p_H \rVert_2 / \lVert p_H \rVert_2 . $$
#
# Hertz's pressure has an infinite slope at the edge. Strips nevertheless converge; peak and area
# converge faster, because errors at the edge affect them little. On a regular grid the edge is a staircase: errors are
# of similar size, but they scatter, and the area has an error of whole cells.


# %%
def errors(solution):
    """Relative errors of pressure (RMS over the patch), peak and area."""
    data, patch = solution.data, solution.patches.iloc[0]
    hertz = exact.pressure(*data.position.values[:, :2].T)
    square = np.average((data.pressure - hertz) ** 2, weights=data.area) / np.average(hertz**2, weights=data.area)
    return np.sqrt(square), patch.max_pressure / exact.peak - 1, patch.area / (np.pi * a**2) - 1


strips = np.array([errors(pair(strips=n, cells=n).solve(load=LOAD)) for n in STRIPS])
grid = np.array([errors(pair(points="grid", surface_size=size).solve(load=LOAD)) for size in GRIDS])
across_strips, across_grid = np.array(STRIPS), 2 * a / np.array(GRIDS)
order = -slope(across_strips, strips[:, 0])

convergence_figure, panels = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained", sharey=True)
for ax, title, across, error in (
    (panels[0], "strips and cells", across_strips, strips),
    (panels[1], "regular grid", across_grid, grid),
):
    series = dict(zip(("pressure, RMS", "peak", "area"), error.T, strict=True))
    wr.plot_convergence(across, series, xlabel="cells across the patch [1]", ax=ax)
    ax.set(title=title, xticks=[4, 8, 16, 32])
    ax.xaxis.set_major_formatter("{x:g}")
    ax.xaxis.set_minor_formatter("")
print(f"order of the pressure on strips: {order:.2f}; on the grid: {-slope(across_grid, grid[:, 0]):.2f}")
assert 0.7 < order < 1.3

# %% [markdown]
# ## Error estimate
#
# Real profiles have no closed-form solution. `error_estimate=True` repeats the solve at the same position twice on half
# as many cells in each direction, the strips offset by half a strip, and derives the estimate from the differences.
# Forces converge faster than pressures, nearly with second order, and a second-order error is a third of that
# difference: the estimate is conservative. It is compared here with the error against the finest solution, at a fixed
# approach.

# %%
approach = {"approach": exact.approach}
finest = pair(strips=40, cells=40).solve(**approach).data.vertical_force.item()
estimated = {n: pair(strips=n, cells=n).solve(**approach, error_estimate=True).data for n in STRIPS if 8 <= n <= 24}
for n, data in estimated.items():
    force, estimate = data.vertical_force.item(), data.force_error.item()
    print(f"{n} x {n} cells: {force:.1f} N, error {abs(force - finest):.1f} N, estimate {estimate:.1f} N")
assert all(abs(data.vertical_force.item() - finest) < data.force_error.item() for data in estimated.values())

# %% [markdown]
# ## Approach of finite bodies
#
# The finite size of the bodies does not affect the pressure, but it affects the **approach**, the relative displacement
# of distant points: a block of half width and depth $D$, fixed at its bottom, does not include the deformation below.
# By Saint-Venant's principle this deformation depends on the force only, so each of the two blocks is displaced by
# $\kappa F/(ED)$ less than a half-space, with one constant $\kappa$ for all loads. This is about one per cent of
# $\delta$: larger blocks are not needed, but the definition of the approach matters when it is used for a contact
# spring in a multibody model. Wheel and rail are modelled with their true size.

# %%
difference, kappa = [], []
for load in LOADS:
    block, hertz = pair(strips=24, cells=24).solve(load=load), pair().closed_form(load=load)
    size = block.data.attrs["surface_size"]
    D = size * 2 ** np.ceil(np.log2(40 * hertz.semi_axes[0] / size))  # depth of the meshed block
    less = hertz.approach - block.data.approach.item()
    difference.append(less / hertz.approach)
    kappa.append(less * E * D / (2 * load))
print("difference [% of the approach]:", *np.round(100 * np.array(difference), 2))
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
# The maximum shear stress is $\tau = |\sigma_z-\sigma_r|/2 = 0.31\,p_0$ at $0.48\,a$ below the surface, and the von
# Mises stress is twice this value: yield, and cracks by rolling contact fatigue, begin below the surface (a line
# contact has $0.30\,p_0$ at $0.79\,a$).

# %%
zeta = np.array(DEPTHS)
below_patch = pair().solve(load=LOAD, stress={"depths": zeta * a, "body": "lower"}).data.isel(side=0, body=0, patch=0)
sigma = below_patch.stress.values / exact.peak
line = np.linspace(1e-3, zeta[-1], 400)
sigma_r = -(1 + NU) * (1 - line * np.arctan(1 / line)) + 0.5 / (1 + line**2)
sigma_z = -1 / (1 + line**2)
mises = below_patch.von_mises.values / exact.peak

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

# %% [markdown]
# ## In three dimensions
#
# The bodies with their displacements magnified, the pressure on the patch, and the von Mises stress on two cuts through
# it. The view turns with the left mouse button and zooms with the right one; it needs the extra `view`.

# %% tags=["view", "remove-output"]
pair().solve(load=LOAD).view().show()
