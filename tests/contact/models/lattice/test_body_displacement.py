"""Displacement of each body of a contact on a lattice, and the rolling radius of the material that touches."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.bindings._contact import (
    CELLS,
    COMPONENTS,
    DEGREE,
    NN,
    PATCH_NUMBERS,
    ROLL,
    START,
    TN,
    TT,
    BodyDisplacements,
    Deviation,
    HalfSpaces,
    LatticeStrips,
    PatchSums,
    count_of,
    on_material,
    pair_coefficients,
    start_of,
    store_patch,
)
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.pair_grid import RULE
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array

ANGLE, RADIUS, YIELDING = -0.3, 0.46, 1e-9  # rad of a flange; m; m/N along the axle


def rigid_yielding(weight: Array) -> Deviation:
    """A body that a force moves as a whole along the axle, tables in the axes of a strip of the inclination `ANGLE`."""
    tangent, normal = np.cos(ANGLE), -np.sin(ANGLE)  # along the axle
    lines = np.zeros((1, 1, count_of(START), DEGREE + 1, COMPONENTS))
    for cell in range(lines.shape[2]):
        base = 2.0 ** (cell // CELLS)
        z = base * (1 + (cell % CELLS) / CELLS) - 1
        square = np.array([z * z, 2 * z, 1.0]) * START**2 / 2  # x^2 / 2 of the antiderivative
        for component, factor in ((TT, tangent**2), (NN, normal**2), (TN, tangent * normal)):
            lines[0, 0, cell, :3, component] = YIELDING * factor * square
    return Deviation(lines, 0, weight)


def table(deviations: tuple[Deviation, Deviation], x: float) -> Array:
    """Components (COMPONENTS,) of a strip on itself at x m."""
    strips = LatticeStrips(np.array([-5e-4, 5e-4]), np.array([ANGLE]), np.ones(1))
    bodies = HalfSpaces(np.full(2, 0.3), np.zeros(2), np.array([1.0, -1.0]), RADIUS)
    start = start_of(strips, 0, 0)
    values = np.zeros((count_of(start), DEGREE + 1, COMPONENTS))
    pair_coefficients(strips, 0, 0, bodies, *deviations, RULE, values)
    z = 1 + x / start
    octave = int(np.log2(z))
    cell = octave * CELLS + int((z / 2**octave - 1) * CELLS)
    u = z - 2.0**octave * (1 + cell % CELLS / CELLS)
    return np.asarray(u ** np.arange(DEGREE + 1) @ values[cell])


def test_a_wheel_that_moves_along_its_axle_rolls_on_the_radius_of_its_material() -> None:
    """Its material does not move radially. At a strip, a place in space, the radius of the undeformed wheel grows by
    r'(s) u_t over that of the material there, by which the slip of the tables has to be smaller.
    """
    none = Deviation(np.zeros((0, 0, 0, DEGREE + 1, COMPONENTS)), 0, np.zeros((0, 0)))
    x = 7e-3
    components = table((rigid_yielding(np.ones((1, 1))), none), x)
    assert components[TT] == pytest.approx(YIELDING * np.cos(ANGLE) ** 2 * x**2 / 2)
    # per unit pressure along the inward normal both u_t and the radius change; ROLL is the integral along x
    lateral = YIELDING * np.cos(ANGLE) * -np.sin(ANGLE) * x**3 / 6
    assert components[ROLL] == pytest.approx(-np.sin(ANGLE) * lateral / RADIUS, rel=1e-9)


@pytest.mark.parametrize(("modulus", "fraction"), [(210e9, 0.5), (70e9, 0.25)])
def test_half_spaces_divide_their_displacement_by_their_compliance(modulus: float, fraction: float) -> None:
    """Under a lateral creepage each body's material comes from where its displacement has taken it."""
    how = Discretisation(1e-3, bodies="half-space", points="lattice")
    radii, materials = ((0.46, 0.3), (np.inf, np.inf)), (Material(), Material(E=modulus))
    model = hertz_pair(radii, materials, ContactLaws(friction=0.3), how, approach=1e-4)
    back, creep = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 5e-3, 0.0])
    motion = RigidMotion(Twist(back + creep, np.zeros(3), np.zeros(3)), Twist(back, np.zeros(3), np.zeros(3)))
    result = model(hertz_pose(1e-4), motion)
    (patch,) = result.patches
    assert result.fields is not None
    load = result.fields.pressure * result.fields.area
    place, relative = load @ np.column_stack([result.fields.point[:, 1], result.fields.displacement[:, 1]]) / load.sum()
    assert relative < -2e-5
    assert place - patch.wheel_s == pytest.approx(fraction * relative, rel=1e-6)
    assert place - patch.rail_s == pytest.approx((fraction - 1) * relative, rel=1e-6)


def patch_from(sums: PatchSums) -> Patch:
    rows = np.empty((1, PATCH_NUMBERS))
    store_patch(sums, sums.peak, rows[0])
    return patches_of(rows)[0]


def test_a_body_that_turns_takes_its_surface_along() -> None:
    """A rotation by 2 mrad lifts a surface in proportion to s: the contact angle is smaller by as much."""
    s, load = np.array([-1e-3, 0.0, 1e-3, 2e-3]), np.array([1.0, 3.0, 2.0, 1.0])
    turned = BodyDisplacements(np.full(4, 1e-4), np.full(4, -2e-5), 5e-5 + 2e-3 * s)
    axes = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(0.1), np.sin(0.1)], [0.0, -np.sin(0.1), np.cos(0.1)]])
    places = np.array([-0.02, -0.021]), np.array([-0.025, -0.026]), np.array([-0.022, -0.02, -0.027, -0.025])
    loads = 1e-4, 0.0, 1e9, np.array([0.0, 0.0, 1e4])
    sums = PatchSums(*loads, axes, 0.0, np.zeros(3), *places, np.full(2, 5e-3), (0.0, 0.0, 0.0), 0.0, 0)
    patch, moved = (patch_from(at) for at in (sums, on_material(sums, turned, s, load)))
    assert patch.contact_angle == pytest.approx(0.1)
    assert moved.contact_angle == pytest.approx(0.098)
    assert moved.wheel_s == pytest.approx(-0.0201)
    assert moved.rail_y - patch.rail_y == pytest.approx(2e-5 * np.cos(0.1))
    assert moved.wheel_band == pytest.approx(np.array(patch.wheel_band) - 1e-4 * np.cos(0.1))
    alone = patch_from(
        on_material(
            sums, BodyDisplacements(turned.wheel[:1], turned.rail[:1], turned.wheel_normal[:1]), s[:1], load[:1]
        )
    )
    assert alone.contact_angle == patch.contact_angle
