"""Contact anywhere on the profiles is solved, or the status names it: flange tip and back, grooves, check rails."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from dense_surfaces import DenseSurfaces
from grooved_rails import grooved

import wheelrail as wr
from wheelrail.contact.geometry.first_contact import first_contacts_over
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.meshes.profiles.named import named_profile

LOAD, WHEEL = 60e3, named_profile("S1002")
QUICK = {"standard": {"model": "standard"}, "strips": {"bodies": "half-space", "strips": 6, "cells": 6}}


@pytest.mark.parametrize("model", sorted(QUICK))
@pytest.mark.parametrize(
    ("groove", "y", "touching"),
    [
        ((27.5e-3, 45e-3), 0.0, -55.0),  # the tip on the floor
        ((28.6e-3, 45e-3), 0.0, -10.0),
        ((33e-3, 38e-3), -4e-3, -67.3),  # the back on the check rail
    ],
)
def test_no_overlap_outside_the_patches(
    tmp_path: Path, model: str, groove: tuple[float, float], y: float, touching: float
) -> None:
    rail = grooved(tmp_path, *groove)
    solver = wr.Wheelset("S1002", rail, friction=0.0, **QUICK[model])
    solved = solver.solve(y=y, wheel_load=LOAD)
    assert solved.status == "converged"
    patches = solved.results["left"].patches
    assert 1e3 * patches[0].wheel_y == pytest.approx(touching, abs=0.1)
    state_z = float(solved.data["z"].sel(side="left"))
    pose, _ = solver.rigid.mounting.left_pair(WheelsetState(y=y, z=state_z))
    places, depths = DenseSurfaces(solver.rigid.pair.wheel, solver.rigid.pair.rail, 0.46).overlaps(pose)
    assert depths.max() == pytest.approx(solved.results["left"].approach, rel=0.1)
    for place in places[depths > 2e-6].tolist():
        assert any(patch.wheel_band[0] - 2e-3 < place < patch.wheel_band[1] + 2e-3 for patch in patches)


def test_first_contacts_up_to_derailment() -> None:
    """Both wheels touch and nothing overlaps, until one of them falls beside its rail."""
    wheelset = wr.Wheelset("S1002", "60E1", model="standard").rigid
    dense = DenseSurfaces(wheelset.pair.wheel, wheelset.pair.rail, wheelset.pair.radius)
    ys = np.array([-0.078, -0.05, -0.012])
    for y, (state, touches) in zip(ys, first_contacts_over(wheelset, ys), strict=True):
        assert state.y == y
        for side in SIDES:
            pose, _ = wheelset.mounting.left_pair(state if side == "left" else state.mirrored())
            assert dense.overlaps(pose)[1].max(initial=0.0) < 1e-8
            own = touches[side].point[None, 1:]
            assert dense.distances(own)[0] < 1e-8
    with pytest.raises(ValueError, match=r"y = -0\.08[0-9]* m: the wheel is beside the rail"):
        first_contacts_over(wheelset, np.array([-0.09]))


def test_a_contact_at_the_end_of_a_file_is_named(tmp_path: Path) -> None:
    """A patch that reaches the last point of a rail's file is not solved as if the rail ended there."""
    head, steel, laws = wr.profile("60E1"), Material(), ContactLaws(friction=0.0)
    pose, motion = Mounting(0.75, 0.7535, 0.46).left_pair(WheelsetState(y=1e-3, z=-4e-4))
    low, high = StandardContact(RigidWheelRail(WHEEL, head, 0.46), laws)(pose, motion).patches[0].rail_band
    points = head.point(head.samples(2e-4))
    np.savetxt(tmp_path / "cut.txt", 1e3 * points[points[:, 0] > 0.5 * (low + high)], fmt="%.7f")
    cut = wr.profile(tmp_path / "cut.txt", "rail", noise=0.0)
    strips = wheel_rail_pair(
        (WHEEL, cut), 0.46, (steel, steel), laws, Discretisation(1e-3, bodies="half-space", strips=6)
    )
    for model in (StandardContact(RigidWheelRail(WHEEL, cut, 0.46), laws), strips):
        status = model(pose, motion, None).status
        assert status.startswith("failed: the wheel overlaps the rail ")
        assert "mm deep at y = " in status


def test_the_last_point_of_a_wheel_touches_before_any_strip(tmp_path: Path) -> None:
    """Its overlap is less than what a strip resolves as a mean over its width: no strip penetrates, but no gap is."""
    y = np.linspace(-30e-3, 30e-3, 1201)
    np.savetxt(tmp_path / "disc.txt", 1e3 * np.column_stack([y, np.sqrt(1.0 - y**2) - 1.0]), fmt="%.9f")
    wheel, rail, steel = wr.profile(tmp_path / "disc.txt", "wheel", noise=0.0), wr.profile("60E1"), Material()
    mounting = Mounting(0.75, 0.7535, 0.46)
    rigid = RigidWheelRail(wheel, rail, 0.46)
    model = wheel_rail_pair(
        (wheel, rail),
        0.46,
        (steel, steel),
        ContactLaws(friction=0.0),
        Discretisation(1e-3, bodies="half-space", strips=6),
    )
    dense = DenseSurfaces(wheel, rail, 0.46)
    touching = WheelsetState(y=45e-3, z=0.0)
    for _ in range(3):
        touching = replace(touching, z=touching.z + rigid.nearest(mounting.left_pair(touching)[0])[1])
    for lift in (2e-6, -1e-6, -4e-6, -8e-6):
        pose, motion = mounting.left_pair(replace(touching, z=touching.z + lift))
        overlap = dense.overlaps(pose)[1].max(initial=0.0)
        assert overlap == pytest.approx(max(-lift, 0.0), abs=3e-7)
        status = model(pose, motion, None).status
        assert (status == "separated") if lift > 0 else re.search(r"rail .*at y = -(29\.9|30\.0), ", status), status
