"""Solves of tests/contact/models/test_mpi.py on one process and, by mpirun, on two: prints JSON on the first rank."""

from __future__ import annotations

import json
import sys
from functools import partial
from typing import Any

import numpy as np
from small_pairs import CREEP, STEEL, TETRAHEDRA, quadrics, solid

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose, hertz_under_load
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.full.model import FullContact, FullStart
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.support.mpi import world

SIZE, RADIUS = 1e-3, 0.3
PAPER, FRICTIONLESS = ContactLaws(1e15, friction=0.3, regularisation=1e-5), ContactLaws(1e15, friction=0.0)


def pair(laws: ContactLaws, **options: Any) -> FullContact:
    """A sphere on a plane of another material, split over all ranks."""
    upper, lower = (
        ElasticBody(solid(TETRAHEDRA)[0].mapped(partial(np.multiply, SIZE)), steel, ranks=world())
        for steel in (STEEL, Material(180e9, 0.2))
    )
    geometry = quadrics(TETRAHEDRA, (RADIUS, RADIUS), (np.inf, np.inf), SIZE)
    return FullContact(geometry, upper, lower, laws, options=FullOptions(**options))


def numbers(model: FullContact, result: ContactResult) -> dict[str, Any]:
    """What must not depend on the number of ranks, and how much of the meshes this rank has."""
    assert result.fields is not None, result.status
    assert isinstance(result.warm_start, FullStart)
    displacement = result.warm_start.displacement
    assert len(displacement) == 3 * (model.wheel.owned + model.rail.owned)
    fields = result.fields
    return {
        "force": result.force.tolist(),
        "moment": result.moment.tolist(),
        "peak": [patch.max_pressure for patch in result.patches],
        "stick": [patch.stick_area for patch in result.patches],
        "pressure": fields.pressure.tolist(),
        "traction": fields.traction.ravel().tolist(),
        "moved": fields.displacement.ravel().tolist(),
        "displacement": [model.wheel.ranks.norm(displacement)],
        "newton": result.statistics.newton,
        "owned": [model.wheel.owned, model.rail.owned],
    }


def overlapping(cells: float) -> Any:
    return hertz_pose((cells * SIZE) ** 2 / (2 * RADIUS))


def on_rail() -> dict[str, Any]:
    """An S1002 wheel on a UIC60 rail without friction, by the meshes that scenes use."""
    wheel, rail = load_profile("S1002", "wheel"), load_profile("UIC60-benchmark", "rail")
    how = Discretisation(8e-3, model="full")
    model = wheel_rail_pair((wheel, rail), 0.46, (Material(), Material()), FRICTIONLESS, how)
    assert isinstance(model, FullContact)
    state = WheelsetState(y=0.002, z=-2e-4, speed=45.0, pitch_rate=45.0 / 0.46)
    pose, motion = Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46).left_pair(state)
    return numbers(model, model(pose, motion))


def searched() -> dict[str, Any]:
    """Load search: every rank has the same trials."""
    model = pair(FRICTIONLESS, preconditioner="icc")
    found = hertz_under_load(model, CREEP, 8e3, expected=1.5e-5, rtol=1e-7)
    return {**numbers(model, found.results[0]), "trials": found.trials}


def solved() -> dict[str, dict[str, Any]]:
    paper, exact = pair(PAPER), pair(ContactLaws())
    multigrid = pair(FRICTIONLESS, preconditioner="gamg", forcing=1e-3)
    first = paper(overlapping(3.2), CREEP)
    return {
        "paper": numbers(paper, first),
        "warm": numbers(paper, paper(overlapping(3.2), CREEP, first)),
        "exact": numbers(exact, exact(overlapping(3.2), CREEP)),
        "multigrid": numbers(multigrid, multigrid(overlapping(3.2), CREEP)),
        "load": searched(),
        "wheel on rail": on_rail(),
    }


def stumble() -> None:
    """Raises an error on the second rank while the first solves."""
    model = pair(PAPER)
    if not world().first:
        raise MemoryError("out of memory on one rank")
    model(overlapping(3.2), CREEP)


if __name__ == "__main__":
    if sys.argv[1:] == ["stumble"]:
        stumble()
    found = world().comm.gather(solved())
    if world().first:
        print(json.dumps(found))
