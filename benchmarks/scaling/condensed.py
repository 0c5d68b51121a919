"""Condensed contact by number of contact points: seconds by phase, memory, and error of the forces."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.common.hertz_cases import block_correction
from benchmarks.common.measurement import Row
from benchmarks.common.models import Ellipse, carrying, frictional, frictionless, hertz_model, rolling
from benchmarks.common.reference_table import reference
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.laws.material import Material
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.discretisation import Bodies, Points
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.solvers.options import LinearSolver, NewtonOptions

CURVE, CASE = 1, 2  # of creep_curves.json: a round patch, the third mixed case, at 0.59 of mu F_n
ALONG = 4 / 3  # cells of a strip by number of strips
LINES = 285  # points of a grid as fine as the lines under the strips
LOADED = 0.75  # of the strips over a usual patch, in an ellipse
ENOUGH, MOST = 0.6, 5  # seconds and repeats
AGAIN = 5.0  # s: a solve that takes longer is not repeated
TASKS: dict[str, LinearSolver | None] = {"normal": None, "rolling, LU": "lu", "rolling, BiCGStab": "bicgstab"}


def solves(*, points: Points, bodies: Bodies, wanted: int, tasks: list[str]) -> Iterator[Row]:
    """Rows for one number of points, by task: median seconds, by phase, MB of one solve, errors in % of the load and of
    mu F_n.

    Computed at the approach for Hertz's load on these bodies. Solves of less than AGAIN seconds are repeated; memory is
    traced separately from time.
    """
    curve = reference("creep_curves")["curves"][CURVE]
    _, xi, eta, phi, *contact_forces = [case for case in curve["cases"] if case[0] == "mixed"][CASE]
    pair = Ellipse((curve["Rx"] * 1e-3, curve["Ry"] * 1e-3), curve["Fn"], Material(curve["E"] * 1e6, curve["nu"]))
    size = pair.size(points=wanted if points == "grid" else LINES)
    depth = pair.exact.approach
    if bodies == "waveguide":  # finite blocks
        depth -= 2 * block_correction(pair.steel.nu)[0] * pair.load / (pair.steel.E * pair.half_width(size))
    loaded = max(4, round(np.sqrt(wanted / ALONG)))
    choices: dict[str, Any] = {}
    if points != "grid":
        choices = {"strips": round(loaded / LOADED), "cells": max(6, round(wanted / loaded))}
    laws = frictional(curve["mu"])  # with room upstream
    model = hertz_model(pair, laws, size, bodies=bodies, points=points, **choices)
    assert isinstance(model, CondensedContact | LatticeContact)
    # a first solve computes spectra, tables and compiled kernels, which all solves share
    coarse = replace(model, resolution=LatticeResolution(4, 8)) if isinstance(model, LatticeContact) else model
    if isinstance(model, LatticeContact):
        coarse(hertz_pose(depth), rolling(xi), None)
    replace(coarse, laws=frictionless())(hertz_pose(depth), rolling(0.0), None)
    bound = curve["mu"] * pair.load
    for task in tasks:
        linear = TASKS[task]
        laws = frictional(curve["mu"]) if linear else frictionless()
        variant: Any = replace(model, laws=laws)
        if isinstance(model, CondensedContact):
            variant = replace(variant, options=NewtonOptions(linear=linear or "lu"))
        motion = rolling(xi, eta, 1e3 * phi) if linear else rolling(0.0)
        result, seconds, phases, memory = timed(variant, depth, motion)
        if result.status != "converged":
            raise RuntimeError(f"Error: contact {result.status}")
        row: Row = {
            "task": task,
            "points": carrying(result),
            "candidates": result.statistics.points,
            "seconds": seconds,
            "phases": phases,
            "newton": result.statistics.newton,
            "linear": result.statistics.linear,
            "memory": memory,
            "force error": 100 * float(result.force[2] / pair.load - 1),
        }
        if linear:
            row["creep error"] = 100 * float(np.abs(result.force[:2] / bound - contact_forces[:2]).max())
        yield row


def timed(
    model: Callable[..., ContactResult], depth: float, motion: RigidMotion
) -> tuple[ContactResult, float, dict[str, float], float]:
    """Result, median seconds, those by phase, and peak MB allocated during one solve."""
    pose = hertz_pose(depth)
    timings: list[tuple[float, dict[str, float]]] = []

    def traced() -> tuple[ContactResult, float, float]:
        tracemalloc.start()
        start = perf_counter()
        result = model(pose, motion, None)
        seconds, memory = perf_counter() - start, tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()
        return result, seconds, memory

    result, first_seconds, memory = traced()
    if first_seconds < AGAIN:
        memory = traced()[2]
    began = perf_counter()
    while first_seconds < AGAIN and len(timings) < MOST and perf_counter() - began < ENOUGH:
        start = perf_counter()
        result = model(pose, motion, None)
        timings.append((perf_counter() - start, result.statistics.seconds))
    seconds, phases = sorted(timings or [(first_seconds, result.statistics.seconds)], key=lambda timing: timing[0])[
        len(timings) // 2
    ]
    return result, seconds, dict(phases), memory
