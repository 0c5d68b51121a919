"""Memory: solvers are freed with their last reference, caches are bounded."""

from __future__ import annotations

import gc
import weakref
from typing import Any

import numpy as np
import pytest
from small_pairs import CREEP, FLAT, STEEL, TETRAHEDRA, quadrics, solid

import wheelrail as wr
from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.full.model import FullContact
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.models.full.preconditioner import Preconditioner

SIZE, RADIUS = 1e-3, 0.3


def body() -> ElasticBody:
    return ElasticBody(solid(TETRAHEDRA)[0].mapped(lambda points: SIZE * points), STEEL)


def test_deleted_body_frees_matrix_and_factor() -> None:
    gone = body()
    gone.respond(np.array([3]), 2)
    held: list[Any] = [gone.stiffness, gone.factor]
    assert all(held)
    del gone
    gc.collect()
    assert not any(held)  # the handles are empty: PETSc has let go


@pytest.mark.parametrize("preconditioner", ["corrected", "cholesky", "gamg"])
def test_deleted_full_model_frees_its_solver(preconditioner: Preconditioner) -> None:
    laws = ContactLaws(1e15, friction=0.3, regularisation=1e-5)
    geometry = quadrics(TETRAHEDRA, (RADIUS, RADIUS), FLAT, SIZE)
    model = FullContact(geometry, body(), body(), laws, options=FullOptions(preconditioner=preconditioner))
    result = model(hertz_pose((2.2 * SIZE) ** 2 / (2 * RADIUS)), CREEP)
    assert result.ok
    gone = weakref.ref(model.solver), weakref.ref(model.wheel)
    held: list[Any] = [model.solver.stiffness, model.wheel.stiffness]
    assert all(held)
    del model
    gc.collect()
    assert all(one() is None for one in gone)
    assert not any(held)
    assert result.ok  # and needs nothing of it


def test_results_do_not_reference_their_solvers() -> None:
    solutions, gone = [], []
    for radius in (0.45, 0.46, 0.47):
        pair = wr.Hertz((radius, np.inf), friction=0.0, bodies="half-space", strips=6, cells=8)
        solutions.append(pair.solve(load=6e4))
        gone += map(weakref.ref, pair._models.values())
    assert len(gone) == 3
    del pair
    gc.collect()
    assert all(one() is None for one in gone)
    assert all(solution.patches.max_pressure.iloc[0] > 9e8 for solution in solutions)
