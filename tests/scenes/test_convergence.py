"""Convergence studies: references, averages, skipped cases, orders and their figures."""

from __future__ import annotations

from itertools import count
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from scipy.stats import linregress
from study_workers import Here

from wheelrail.contact.analytical.hertz import Hertz, hertz, modulus
from wheelrail.scenes.contacts import solve as solve_module
from wheelrail.scenes.plots.fits import line_fit
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import checked
from wheelrail.scenes.studies.convergence import increasing, series_of
from wheelrail.scenes.studies.plan import Plan, plan
from wheelrail.scenes.studies.plots import drawings
from wheelrail.scenes.studies.run import run_study
from wheelrail.scenes.studies.schema import check_study, load_study
from wheelrail.scenes.studies.tables import order_table, series_label

SCENES = Path(__file__).parents[2] / "scenes"
BODY = {"radii": [0.3, 0.3], "E": 210e9, "nu": 0.3}
FLAT = {**BODY, "radii": [float("inf"), float("inf")]}
CLOSED = {"kind": "hertz", "model": "standard", "normal": "hertz", "load": 1e4, "friction": 0.0, "lower": FLAT}
CLOSED |= {"upper": BODY}
MESHED = {"kind": "hertz", "load": 1e4, "friction": 0.0, "upper": BODY, "lower": FLAT, "half_strip": 4.6e-3}
STEEL = (210e9, 0.3)


def planned(**what: Any) -> Plan:
    return plan(check_study({"scene": CLOSED, **what}))


def sphere(load: float, nu: float = 0.3) -> Hertz:
    """Closed-form solution of the sphere on the plane."""
    return hertz(0.5 / 0.3, 0.5 / 0.3, modulus((210e9, nu), STEEL), force=load)


# References


def test_a_reference_may_be_common_to_other_dimensions(here: Here) -> None:
    grid = {"load": [1e4, 2e4], "upper.nu": [0.3, 0.2]}
    reference = {"load": 4e4, "upper.nu": 0.25}
    data = run_study({"scene": CLOSED, "grid": grid, "convergence": {"over": "load", "reference": reference}})
    assert len(here.jobs) == 5
    np.testing.assert_allclose(data["reference_max_pressure"], sphere(4e4, 0.25).peak, rtol=1e-6)
    expected = 1.0 - sphere(1e4, 0.2).peak / sphere(4e4, 0.25).peak
    assert float(data["relative_error_max_pressure"].sel(load=1e4, upper_nu=0.2)) == pytest.approx(expected, rel=1e-5)


def test_a_wrong_key_of_a_common_reference_is_named() -> None:
    reference = {"load": 4e4, "upper.mu": 0.25}
    with pytest.raises(SceneError, match=r"convergence\.reference\.upper\.mu"):
        planned(grid={"load": [1e4, 2e4]}, convergence={"reference": reference})


@pytest.mark.parametrize(
    ("values", "reference", "finer"), [([1e13, 1e14], np.inf, True), ([1e-3, 1e-4], 0.0, False), ([2e4], 3e4, True)]
)
def test_finer_is_the_side_of_the_reference(values: list[float], reference: float, finer: bool) -> None:
    name = "stiffness_per_area" if reference == np.inf else "load" if reference > 0.0 else "regularisation"
    scene = {**MESHED, "surface_size": 1e-3, "laws": "paper"}
    study = {"scene": scene, "grid": {name: values}, "convergence": {"reference": {name: reference}}}
    cases = plan(check_study(study))
    assert cases.convergence is not None
    assert increasing(cases, cases.convergence) is finer


# Skipped cases, averages, fits


def test_skipped_cases_are_not_computed_and_leave_the_fit(here: Here) -> None:
    grid = {"load": [1e4, 2e4, 3e4], "friction": [0.0, 0.1]}
    rolling = {"speed": 10.0, "creepage": [0.0, 0.0, 0.0]}
    skip = [{"load": [1e4], "friction": [0.1]}]
    convergence = {"over": "load", "reference": {"load": 4e4}, "quantities": ["area"]}
    data = run_study({"scene": {**CLOSED, **rolling}, "grid": grid, "skip": skip, "convergence": convergence})
    assert len(here.jobs) == 7  # six cases and two references, without one
    assert str(data["status"].sel(load=1e4, friction=0.1).values) == "skipped"
    assert np.isnan(data["relative_error_area"].sel(load=1e4, friction=0.1))
    error = 1.0 - np.array([0.25, 0.5, 0.75]) ** (2.0 / 3.0)
    size = 1.0 / np.array([1e4, 2e4, 3e4])
    for friction, first in ((0.0, 0), (0.1, 1)):
        order = line_fit(size[first:], error[first:])[0]
        assert float(data["order_area"].sel(friction=friction)) == pytest.approx(order, rel=1e-4)


def test_errors_are_averaged_over_dimensions_before_the_fit(here: Here) -> None:
    grid = {"load": [1e4, 2e4, 4e4], "upper.nu": [0.3, 0.2]}
    reference = {"load": 8e4, "upper.nu": 0.3}
    wanted = {"over": "load", "reference": reference, "quantities": ["max_pressure"]}
    single = run_study({"scene": CLOSED, "grid": grid, "convergence": wanted})["relative_error_max_pressure"]
    data = run_study({"scene": CLOSED, "grid": grid, "convergence": {**wanted, "rms_over": ["upper_nu"]}})
    mean = np.sqrt((single**2).mean("upper_nu"))
    np.testing.assert_allclose(data["relative_error_max_pressure"], mean, rtol=1e-12)
    assert data["order_max_pressure"].dims == ()
    fit = linregress(np.log(1.0 / data["load"].values), np.log(mean.values))
    assert float(data["order_max_pressure"]) == pytest.approx(fit.slope, rel=1e-9)
    assert float(data["order_error_max_pressure"]) == pytest.approx(fit.stderr, rel=1e-9)
    assert len(series_of(data)) == 1


def test_only_the_finest_sizes_are_fitted() -> None:
    size, error = np.array([1.0, 0.5, 0.25, 0.125]), np.array([1.0, 1.0, 0.25, 0.0625])
    assert line_fit(size, error, 3) == pytest.approx((2.0, 0.0), abs=1e-12)
    assert line_fit(size[::-1], error[::-1], 2)[0] == pytest.approx(2.0)
    assert line_fit(size, error)[0] < 1.6
    assert np.isnan(line_fit(size, error, 2)[1])


BAD = {
    "quantity": ({"quantities": ["max_presure"]}, "max_presure: must be a quantity of the results; did you mean max_p"),
    "average": ({"rms_over": ["friction"]}, 'rms_over = "friction": must be a dimension'),
    "own average": ({"rms_over": ["load"]}, 'rms_over = "load": must not be the dimension of convergence'),
    "too few": ({"finest": 1}, "finest = 1: must be a whole number from 2"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_wrong_entry_of_the_convergence_is_named(name: str) -> None:
    what, message = BAD[name]
    with pytest.raises(SceneError) as caught:
        planned(grid={"load": [1e4, 2e4]}, convergence={"reference": {"load": 4e4}, **what})
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("skip", "message"),
    [
        ({"friction": [0.1]}, "friction: must be a parameter of"),
        ({"load": [5e4]}, "load: 50000.0 must be one of its values"),
        ({"load": [1e4, 2e4]}, "skip: leaves no case"),
    ],
)
def test_a_wrong_skip_is_named(skip: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError) as caught:
        planned(grid={"load": [1e4, 2e4]}, skip=[skip])
    assert message in str(caught.value)


# Times and figures


def test_warm_times_are_measured_in_convergence_studies_only(here: Here) -> None:
    plain = run_study({"scene": CLOSED, "grid": {"load": [1e4, 2e4]}})
    assert "warm_seconds" not in plain
    scene = {**MESHED, "bodies": "waveguide", "points": "grid", "surface_size": 1.3e-3}
    timed = run_study({"scene": scene, "grid": {"load": [8e3, 1e4]}, "convergence": {"reference": "hertz"}})
    assert (timed["warm_seconds"] > 0.0).all()
    assert float(timed["warm_seconds"].min()) < float(timed["seconds"].max())
    assert timed["warm_seconds"].attrs["units"] == "s"


def test_warm_times_are_without_what_a_first_solve_computes(here: Here, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model whose first call takes 0.3 s, as compilation and compliances do."""
    model = solve_module.built_model(checked(CLOSED))
    calls = count()

    def cold_at_first(*arguments: Any) -> Any:
        if next(calls) == 0:
            sleep(0.3)
        return model(*arguments)  # type: ignore[operator]

    monkeypatch.setattr(solve_module, "built_model", lambda _: cold_at_first)
    data = run_study({"scene": CLOSED, "grid": {"load": [1e4, 2e4]}, "convergence": {"reference": "hertz"}})
    assert next(calls) > 2
    assert float(data["warm_seconds"].max()) < 0.1


def test_every_series_has_its_line_and_its_order(here: Here) -> None:
    grid = {"load": [1e4, 2e4, 4e4], "upper.nu": [0.3, 0.2]}
    wanted = {"over": "load", "reference": {"load": 8e4}, "quantities": ["max_pressure", "area"]}
    data = run_study({"scene": CLOSED, "grid": grid, "convergence": wanted})
    labels = [series_label(data, place) for place in series_of(data)]
    assert labels == ["upper.nu = 0.3", "upper.nu = 0.2"]
    figure = drawings(data)["convergence"](data, None)
    assert figure is not None
    assert [text.get_text() for text in figure.legends[0].get_texts()] == labels
    assert len(figure.axes) == 4  # two quantities, over size and over time
    for axes, name in zip(figure.axes[::2], ("max_pressure", "area"), strict=True):
        assert axes.get_xlabel() == "load [N]"
        assert axes.get_ylabel() == f"error of {name.replace('_', ' ')} [%]"
        for line, place in zip(axes.lines, series_of(data), strict=True):
            np.testing.assert_allclose(line.get_ydata(), 100.0 * data[f"relative_error_{name}"].isel(place))
    assert {axes.get_xlabel() for axes in figure.axes[1::2]} == {"warm time of the contact solves [s]"}
    legend = figure.axes[1].get_legend()
    assert legend is not None
    pairs = zip(data["order_max_pressure"].values, data["order_error_max_pressure"].values, strict=True)
    expected = [f"{order:.2f} ± {deviation:.2f}" for order, deviation in pairs]
    assert [text.get_text() for text in legend.get_texts()] == expected
    assert len(order_table(data).rows) == 2


# Scenes


@pytest.mark.parametrize("name", ["study_fe_mesh", "study_fe_force", "study_penalty", "study_regularisation"])
def test_studies_of_the_mesh_and_the_laws_are_valid(name: str) -> None:
    file = SCENES / f"{name}.toml"
    cases = plan(load_study(file), file)
    assert cases.convergence is not None
    assert len(cases.cases) > 5


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"bodies": "half-space", "half_width": 0.1}, "half_width = 0.1: allowed only with bodies"),
        ({"bodies": "waveguide", "growth": 0.3}, 'growth = 0.3: allowed only with bodies = "solid"'),
        ({"model": "standard", "half_strip": 0.1}, "half_strip = 0.1: allowed only with bodies"),
        ({"bodies": "solid", "growth": 5.0}, "growth = 5.0: must be a number from 0.02 to 2"),
    ],
)
def test_keys_of_blocks_are_only_allowed_for_meshes(keys: dict[str, Any], message: str) -> None:
    scene = {**MESHED, "surface_size": 1e-3, **keys}
    if keys.get("model") == "standard":
        del scene["surface_size"]
    else:
        del scene["half_strip"]
    with pytest.raises(SceneError) as caught:
        checked(scene)
    assert message in str(caught.value)


# Bias of the penalty and of the regularisation, docs/theory/errors.md


def test_the_bias_of_the_penalty_is_of_first_order_with_the_constants_of_the_theory(here: Here) -> None:
    scene = {**MESHED, "laws": "paper", "regularisation": 0.0, "bodies": "waveguide", "points": "grid"}
    K = np.array([3e15, 1e16, 3e16])
    wanted = {"reference": {"stiffness_per_area": float("inf")}, "quantities": ["max_pressure", "approach"]}
    data = run_study(
        {
            "scene": {**scene, "surface_size": 0.4e-3},
            "grid": {"stiffness_per_area": K.tolist()},
            "convergence": wanted,
        }
    )
    exact, E_star = sphere(1e4), modulus(STEEL, STEEL)
    approach = data["approach"] - data["reference_approach"]
    np.testing.assert_allclose(approach * 2.0 * K / exact.peak, 1.0, atol=0.05)
    peak = 1.0 - data["max_pressure"] / data["reference_max_pressure"]
    coefficient = (0.5 + np.pi**2 / 8.0) / np.pi
    np.testing.assert_allclose(peak * K * exact.semi_axes[0] / E_star, coefficient, rtol=0.1)
    for name in ("max_pressure", "approach"):
        assert float(data[f"order_{name}"]) == pytest.approx(1.0, abs=0.03)


def test_the_bias_of_the_regularisation_is_of_first_order(here: Here) -> None:
    rolling = {"friction": 0.3, "speed": 10.0, "creepage": [5e-4, 0.0, 0.0], "surface_size": 0.7e-3}
    scene = {**MESHED, **rolling, "laws": "paper", "stiffness_per_area": float("inf")}
    scene |= {"bodies": "waveguide", "points": "grid"}
    wanted = {"reference": {"regularisation": 0.0}, "quantities": ["longitudinal_force"]}
    grid = {"regularisation": [1e-4, 3e-5, 1e-5, 1e-6]}
    data = run_study({"scene": scene, "grid": grid, "convergence": wanted})
    assert (abs(data["longitudinal_force"]) < abs(data["reference_longitudinal_force"])).all()
    assert float(data["order_longitudinal_force"]) == pytest.approx(1.0, abs=0.05)
    assert (data["relative_error_longitudinal_force"] < data["regularisation"] / 5e-4).all()


# Meshed solids, docs/theory/errors.md

SOLID = {**MESHED, "bodies": "solid", "half_width": 0.11}
LOADS = [12.6e3, 10e3, 8e3]


def refined(sizes: list[float], growth: list[float], **keys: Any) -> Any:
    """Results of a study of solids against Hertz, averaged over loads."""
    convergence = {"over": "surface_size", "reference": "hertz", "rms_over": ["load"]}
    study = {"scene": {**SOLID, "surface_size": 1e-3, **keys}, "convergence": convergence}
    together = [{"surface_size": sizes, "growth": growth}]
    return run_study({**study, "grid": {"load": LOADS}, "together": together})


def test_linear_solids_converge_within_the_orders_of_the_theory(here: Here) -> None:
    """Second order, or first where the staircase of the edge and coarse meshes still dominate."""
    sizes = [1.6e-3, 1.3e-3, 1.1e-3, 0.9e-3]
    data = refined(sizes, [400.0 * size for size in sizes])
    assert set(data["status"].values.flat) == {"converged"}
    for name in ("max_pressure", "semi_axis_x", "semi_axis_y", "area", "approach"):
        order, deviation = float(data[f"order_{name}"]), float(data[f"order_error_{name}"])
        assert order + 2.0 * deviation > 1.0, name
        assert order - 2.0 * deviation < 2.0, name
        assert float(data[f"relative_error_{name}"][-1]) < float(data[f"relative_error_{name}"][0]), name


def test_a_fixed_growth_of_the_elements_leaves_a_floor(here: Here) -> None:
    """Of the order of the square of the growth, whatever the size of the elements at the surface."""
    sizes = [1.6e-3, 0.9e-3]
    fixed, coarse = refined(sizes, [0.64, 0.64]), refined(sizes, [0.64, 0.36])
    error, better = (data["relative_error_approach"].values for data in (fixed, coarse))
    assert error[0] == better[0]
    assert error[1] > 1.3 * better[1]


def test_quadratic_solids_are_more_accurate_on_the_same_mesh(here: Here) -> None:
    """Orders 3 and 2 of force and approach."""
    linear, quadratic = (refined([2e-3], [0.8], degree=degree) for degree in (1, 2))
    assert float(quadratic["relative_error_approach"][0]) < 0.3 * float(linear["relative_error_approach"][0])


def test_the_missing_compliance_of_a_block_is_inverse_to_its_size(here: Here) -> None:
    scene = {**SOLID, "surface_size": 1.6e-3, "growth": 0.3, "cell": "hexahedron"}
    width = np.array([0.016, 0.032, 0.064])
    data = run_study({"scene": scene, "grid": {"half_width": width.tolist()}})
    kappa = np.diff(data["approach"].values) / -np.diff(1.0 / width) * 210e9 / (2.0 * 1e4)
    np.testing.assert_allclose(kappa, 0.37, rtol=0.1)
