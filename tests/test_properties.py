"""Properties that no contact may lack whatever its radii, approach, creepage and laws: Hertz pairs drawn at random."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from contact.fitted import FittedContact
from contact.fitting import Fineness
from contact.laws import Laws, Steel
from contact.loading import hertz_pose
from contact.pairs import hertz_pair
from contact.pose import MIRROR, Motion, Pose, Twist
from contact.result import ContactResult

FEW = settings(
    phases=(Phase.explicit, Phase.generate),
    derandomize=True,
    max_examples=6,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
RADIUS, APPROACH, SIZE = 0.3, 5e-5, 1e-3
CELLS = Fineness(8, 8)
ALIKE = 5e-4  # of the load: the blocks' triangles are no mirror images of each other; 1.7e-4 at worst here

creepages = st.floats(-5e-3, 5e-3)
spins = st.floats(-1.0, 1.0)
ratios = st.sampled_from((0.4, 1.0, 2.5))
frictions = st.floats(0.05, 0.8)
depths = st.floats(5e-6, APPROACH)


@cache
def frictionless(ratio: float, scale: float = 1.0) -> FittedContact:
    """A steel body with radii R and ratio R on a plane; all lengths times the scale."""
    model = hertz_pair(
        (scale * RADIUS, scale * ratio * RADIUS),
        (np.inf, np.inf),
        upper_steel=Steel(),
        lower_steel=Steel(),
        approach=scale * APPROACH,
        surface_size=scale * SIZE,
        laws=Laws(np.inf, 0.0, 0.0),
        bodies="waveguide",
        fineness=CELLS,
        tolerance=1e-7,  # ends as exact as they can be, so that all that is left is the cells
    )
    assert isinstance(model, FittedContact)
    return model


def rolling(xi: float, eta: float, phi: float) -> Motion:
    flow, slip, spin = np.array([-10.0, 0, 0]), 5.0 * np.array([xi, eta, 0.0]), 5.0 * np.array([0.0, 0.0, phi])
    return Motion(Twist(flow + slip, spin, np.zeros(3)), Twist(flow - slip, -spin, np.zeros(3)))


def solved(model: FittedContact, pose: Pose, motion: Motion) -> ContactResult:
    result = model(pose, motion, None)
    assert result.status == "converged"
    return result


def elastic_energy(result: ContactResult) -> float:
    """Half of the work of the tractions through the relative displacement, J."""
    f = result.fields
    assert f is not None
    tractions = np.column_stack([f.traction, -f.pressure])
    return float(0.5 * np.einsum("nk,nk,n->", tractions, f.displacement, f.area))


def dissipated(result: ContactResult, speed: float) -> float:
    """Power lost in the contact, W."""
    f = result.fields
    assert f is not None
    return float(-speed * np.einsum("nk,nk,n->", f.traction, f.slip, f.area))


@FEW
@given(ratios, depths, frictions, creepages, creepages, spins, st.sampled_from((0.0, 1e-5, 1e-3)))
def test_laws_hold_and_friction_never_feeds(
    ratio: float, depth: float, mu: float, xi: float, eta: float, phi: float, eps: float
) -> None:
    model = replace(frictionless(ratio), laws=Laws(np.inf, mu, eps))
    f = solved(model, hertz_pose(depth), rolling(xi, eta, phi)).fields
    assert f is not None
    assert f.pressure.min() >= 0
    assert (np.hypot(*f.traction.T) <= mu * f.pressure * (1 + 1e-7)).all()
    work = (f.traction * f.slip).sum(axis=1)
    # where it sticks the slip is nothing but the solver's residual
    assert work.max() <= 1e-9 * mu * f.pressure.max() * max(np.hypot(*f.slip.T).max(), 1e-9)


@FEW
@given(ratios, depths, frictions, creepages, creepages, spins)
def test_mirror_symmetry(ratio: float, depth: float, mu: float, xi: float, eta: float, phi: float) -> None:
    model = replace(frictionless(ratio), laws=Laws(np.inf, mu, 0.0))
    one = solved(model, hertz_pose(depth), rolling(xi, eta, phi))
    other = solved(model, hertz_pose(depth), rolling(xi, -eta, -phi))
    size = float(np.linalg.norm(one.force))
    assert other.force == pytest.approx(MIRROR * one.force, abs=ALIKE * size)
    assert other.moment == pytest.approx(-MIRROR * one.moment, abs=ALIKE * size * RADIUS)


@FEW
@given(ratios, depths, frictions, st.sampled_from((-4e-2, 4e-2)), st.sampled_from((-4e-2, 4e-2)))
def test_motion_feeds_what_full_sliding_dissipates(
    ratio: float, depth: float, mu: float, xi: float, eta: float
) -> None:
    """Where everything slides one way the tractions are mu p along it, and elastic energy is only carried through:
    the rigid motion's power and the power lost differ by what cells' ends make of that integral.
    """
    model = replace(frictionless(ratio), laws=Laws(np.inf, mu, 0.0))
    result = solved(model, hertz_pose(depth), rolling(xi, eta, 0.0))
    fed = -10.0 * float(result.force[:2] @ [xi, eta])
    assert fed > 0
    assert dissipated(result, 10.0) == pytest.approx(fed, rel=2e-3)


@FEW
@given(ratios, st.floats(1e-5, 4e-5))
def test_force_is_the_slope_of_the_elastic_energy(ratio: float, depth: float) -> None:
    """dE/d(approach) = F without friction, by a central difference that is itself off by 2e-5;
    8 strips of 8 cells leave 0.5 % of the energy.
    """
    model, step = frictionless(ratio), 0.02 * depth
    below, here, above = (solved(model, hertz_pose(depth + k * step), rolling(0, 0, 0)) for k in (-1, 0, 1))
    slope = (elastic_energy(above) - elastic_energy(below)) / (2 * step)
    assert slope == pytest.approx(float(here.force[2]), rel=8e-3)


@pytest.mark.parametrize("ratio", [0.4, 1.0])
def test_force_grows_like_the_approach_to_three_halves(ratio: float) -> None:
    """A fitted slope; finite blocks and their clamped ends lack about 1 % of the approach."""
    at = APPROACH * np.geomspace(0.1, 1.0, 5)
    force = [float(solved(frictionless(ratio), hertz_pose(d), rolling(0, 0, 0)).force[2]) for d in at]
    slope = np.polyfit(np.log(at), np.log(force), 1)[0]
    assert slope == pytest.approx(1.5, abs=0.02)


@FEW
@given(st.sampled_from((1.0, 2.5)), st.sampled_from((0.1, 7.0)), frictions, creepages, spins)
def test_size_invariance(ratio: float, scale: float, mu: float, xi: float, phi: float) -> None:
    """All lengths times c: forces times c^2, moments times c^3."""
    laws: dict[str, Any] = {"laws": Laws(np.inf, mu, 0.0)}
    one = solved(replace(frictionless(ratio), **laws), hertz_pose(APPROACH), rolling(xi, 0.0, phi))
    large = replace(frictionless(ratio, scale), **laws)
    other = solved(large, hertz_pose(scale * APPROACH), rolling(xi, 0.0, phi / scale))
    assert other.force == pytest.approx(scale**2 * one.force, rel=1e-6, abs=1e-6 * scale**2 * one.force[2])
    assert other.moment[2] == pytest.approx(
        scale**3 * one.moment[2], rel=1e-6, abs=1e-6 * scale**3 * one.force[2] * APPROACH**0.5
    )
