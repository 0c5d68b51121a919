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
# # Explore
#
# A contact takes milliseconds, so that it can be moved by hand. The page below shows a wheelset on its rails: move it
# to the left until the flange carries a part of the load, and see the second patch come, the tractions turn, and the
# forces approach the friction bound.

# %%
import matplotlib.pyplot as plt
import numpy as np

import wheelrail as wr

# %% tags=["parameters"]
RESOLUTION = {"strips": 8, "cells": 10}

# %%
page = wr.explore(wr.Wheelset(wheel="S1002", rail="60E1", friction=0.3, **RESOLUTION))
page  # noqa: B018

# %% [markdown]
# ## Take it along
#
# The page's *copy as Python* gives a program for what is seen. In a notebook the solution is at hand, solved with the
# same arguments, to the last bit.

# %%
solution = page.solution()
solution  # noqa: B018

# %% [markdown]
# Its tables and figures are those of every solution.

# %%
axes = solution.plot()

# %% [markdown]
# ## A quantity along a slider
#
# What the page traces along a slider is a series of solves. Here is the lateral force of both wheels over the lateral
# position, without the page.

# %%
wheelset = wr.Wheelset(wheel="S1002", rail="60E1", friction=0.3, **RESOLUTION)
places = np.linspace(-6e-3, 6e-3, 9)
forces = np.array([wheelset.solve(y=y).data["lateral_force"].values for y in places])
figure, ax = plt.subplots(figsize=(6, 3.5))
for name, force in zip(("left", "right"), forces.T, strict=True):
    ax.plot(1e3 * places, 1e-3 * force, "o-", label=name)
ax.set_xlabel("y of the wheelset, positive to the left [mm]")
ax.set_ylabel("lateral force on the wheel, positive to the left [kN]")
legend = ax.legend()

# %% [markdown]
# The page ends with the notebook's kernel, or with `page.close()`.
