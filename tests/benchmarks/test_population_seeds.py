"""Situations that the population found, as values: what they are now, and that the oracle says why."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import wheelrail as wr
from benchmarks.population.checks import broken
from benchmarks.population.draw import MESHED, Situation, with_profiles
from benchmarks.population.judge import judged
from benchmarks.population.profiles import rail, wheel
from benchmarks.population.results import side_result, solved


def on_track(wheelset: dict[str, Any], **solve: Any) -> Situation:
    return Situation(0, {"curvature": 0.0, **wheelset}, solve)


def test_a_finite_wheel_that_touches_beyond_its_points() -> None:
    """Seed 900347: the text named an overlap of 2.6e-5 mm, at which the search for the load had ended."""
    names = ("wheel", "rail", "laying_angle", "radius")
    own = on_track(
        {**dict(zip(names, MESHED[1], strict=True)), "gauge": 1.52, "flange_back_distance": 1.443,
         "friction": 0.00377824, "bodies": "waveguide", "strips": 9, "cells": 6},
        y=-0.0367982, yaw=-0.012231, wheel_load=20688.9, roll=0.0, speed=0.196122,
    )  # fmt: skip
    verdict = judged(own)
    assert "the wheel touches the rail at y = 35.4, z = -1.0 mm of its profile, beyond" in verdict.sides["left"]
    assert verdict.kind == "explained failure"
    assert "beyond the part of a finite wheel" in verdict.reason


def pressed_aside() -> Situation:
    """Seed 900725 with its axle, whose wheels press against the flanks of the rails by 1.1 MN."""
    return on_track(
        {"wheel": wheel("cone", slope=0.025, face=1.309, tread=0.000314667, flange=0.000728814), "rail": rail("60E1"),
         "laying_angle": 0.05, "radius": 0.46, "gauge": 1.676, "flange_back_distance": 1.601, "friction": 0.0,
         "bodies": "half-space", "strips": 6, "cells": 12, "axle": True},
        y=0.0075337, yaw=0.00075339, axle_load=228194.0, roll=0.0, speed=45.1602,
    )  # fmt: skip


def test_a_vertical_face_is_no_contact_of_strips() -> None:
    """Lowered from 3.6 mm the strips failed at 1.2 mm, converged at 0.8 mm, as if nothing were beside them, and failed
    at 0 mm, "where a profile ends".
    """
    own = {key: value for key, value in pressed_aside().wheelset.items() if key not in ("axle", "curvature")}
    pair = wr.Wheelset(**with_profiles(own))
    found = {
        z: pair.solve(y=0.0075337, yaw=0.00075339, z=1e-3 * z, speed=45.1602, sides=("left",)).results["left"].status
        for z in (2.8, 2.0, 1.2, 0.8, 0.4, 0.0)
    }
    assert found[2.8] == found[2.0] == "converged"
    assert all("where the face of the rail is too steep for strips" in found[z] for z in (1.2, 0.8, 0.4, 0.0)), found


def test_a_load_that_presses_a_wheel_against_a_vertical_face() -> None:
    verdict = judged(pressed_aside())
    assert verdict.kind == "explained failure"
    assert verdict.reason == "presses against a vertical face of the rail"


def test_a_strip_whose_end_has_no_solution_is_that_of_finer_strips() -> None:
    """Seed 901922, the right wheel on a flange of 69 degrees: "Newton's method did not converge (3 strips)" at 5 of 17
    heights 1 um apart, at which the end of a strip of 29 mm had no solution.
    """
    own = {"wheel": wheel("cone", slope=0.025, face=1.047, hollow=0.00172175, hollow_field=0.000160276),
           "rail": rail("groove", crown=0.5, radius=0.013, depth=0.047, width=0.042), "laying_angle": 0.025,
           "radius": 0.631353, "gauge": 1.435, "flange_back_distance": 1.358, "friction": 0.810159,
           "bodies": "half-space", "strips": 8, "cells": 8}  # fmt: skip
    pair = wr.Wheelset(**with_profiles(own))
    place = {"y": 0.00515158, "yaw": -2.82896e-05, "roll": 0.000433317, "speed": 7.55994, "y_rate": 0.00567901}
    heights = np.linspace(3.7835e-3, 3.7678e-3, 17)
    found = [pair.solve(z=float(z), **place, sides=("right",)).results["right"] for z in heights]
    assert {result.status for result in found} == {"converged"}
    force = np.array([result.force for result in found])
    assert np.abs(np.diff(force, 2, axis=0)).max() < 1e-4 * np.abs(force).max()


def test_a_wheel_that_friction_pulls_onto_its_rail() -> None:
    """Seed 902101: 0.7 of friction tilts a wheel on an axle that bends, which lowers the wheel by more than the
    load lifts it; heights at which 19 kN without an axle have no equilibrium said "do not settle", without a reason.
    """
    worn = wheel("S1002", hollow=0.000233462, hollow_field=0.000204042, tread=0.00134168, flange=0.00179031)
    own = {"wheel": worn, "rail": rail("arcs", crown=0.254, radius=0.01), "laying_angle": 0.025, "radius": 0.596028,
           "right": {"wheel": wheel("S1002"), "radius": 0.596075}, "gauge": 1.435, "flange_back_distance": 1.36,
           "bodies": "half-space", "strips": 6, "cells": 6, "axle": True}  # fmt: skip
    place = {"y": 8.68936e-06, "yaw": 0.00865956, "z": 0.000561163, "roll": 0.0, "speed": 0.310512}
    pulled = wr.Wheelset(**with_profiles(own), friction=0.707966).solve(**place)
    assert "pulled onto its rail: loads grow as fast as the motions that carry them" in pulled.status
    assert wr.Wheelset(**with_profiles(own), friction=0.1).solve(**place).status == "converged"


def test_resultants_within_the_normals_of_both_models() -> None:
    """Seed 900575: 0.02 of the load between strips and the standard contact, whose patch is the wider one."""
    own = on_track(
        {"wheel": wheel("S1002"), "rail": rail("60E1"), "laying_angle": 0.0260256, "radius": 0.472708, "gauge": 1.435,
         "flange_back_distance": 1.36, "friction": 0.00160812, "bodies": "half-space",
         "right": {"rail": rail("arcs", crown=0.5, radius=0.013), "laying_angle": 0.025}},
        y=0.000446172, yaw=-0.0223525, wheel_load=79784.9, roll=-0.000213783, speed=76.6897,
    )  # fmt: skip
    assert judged(own).kind == "right"


def test_the_origin_of_a_rail_on_pads() -> None:
    """Seed 900945: a flat crown of a worn groove has its top 8 um elsewhere in the oracle; the overlap was 5 um off."""
    groove = rail("groove", crown=0.254, radius=0.01, depth=0.047, width=0.042, flattened=0.000285717, side=0.000578557)
    own = on_track(
        {"wheel": wheel("cone", slope=0.05, face=1.047), "rail": groove, "laying_angle": 0.025, "radius": 0.46,
         "gauge": 1.465, "flange_back_distance": 1.39, "curvature": 0.000426296, "friction": 0.3,
         "bodies": "half-space", "strips": 6, "cells": 10, "pads": True},
        y=-0.0189311, yaw=-0.000875886, z=0.022173101, roll=0.0, speed=0.967561,
    )  # fmt: skip
    result = side_result(solved(own).data, "right")
    assert broken(own, "right", result) == []
    assert any("where the overlap is" in text for text in broken(own, "right", replace(result, approach=5e-6)))
