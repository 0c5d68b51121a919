"""Unused features are not computed: checked by counting imports and calls, not by timing."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_pairs import AT_REST, CREEP, TETRAHEDRA, condensed, full
from small_wheelset import STATE, wheelset

from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance
from wheelrail.contact.geometry import contact_operators as operators_module
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models import condensed as condensed_module
from wheelrail.contact.models.full import model as full_module
from wheelrail.contact.solvers import tractions as tractions_module
from wheelrail.support.mpi import SELF

ROOT = Path(__file__).parents[2]
HEAVY = ("dolfinx", "ufl", "petsc4py", "mpi4py", "gmsh", "pyvista", "xarray", "matplotlib")
SPHERE = (0.3, 0.3)
TOUCHING = hertz_pose(1.5e-5)


def heavy_after(script: str) -> set[str]:
    """Heavy libraries that a fresh process has imported at the end of a script."""
    report = f"\nimport json, sys\nprint(json.dumps([name for name in {HEAVY} if name in sys.modules]))"
    path = os.pathsep.join([str(ROOT), str(ROOT / "tests/helpers")])
    done = subprocess.run(
        [sys.executable, "-c", script + report],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
        cwd=ROOT,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


SOLVE = """
from small_wheelset import STATE, wheelset
from wheelrail.contact.laws.parameters import ContactLaws
for laws in (ContactLaws.penalty(), ContactLaws.penalty(0.0)):
    result = wheelset(laws)(STATE, "left")
    assert result.status == "converged", result.status
    assert result.force[2] > 1e4
"""


def test_a_solve_from_the_cache_imports_no_mesher_and_no_finite_elements() -> None:
    heavy_after(SOLVE)  # fills the cache, should it be empty
    assert heavy_after(SOLVE) == set()


def test_the_standard_contact_needs_no_meshes_and_no_finite_elements() -> None:
    script = f"""
from pathlib import Path
from wheelrail.scenes.contacts.solve import solve_contact, solve_sides
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import parse_scene
text = (Path({str(ROOT)!r}) / "scenes" / "wheelset.toml").read_text()
scene = parse_scene(text.replace('model = "condensed"', 'model = "standard"'))
sides = {{name: side.result.status for name, side in solve_sides(scene)}}
assert sides == {{"left": "converged", "right": "converged"}}
run = (Path({str(ROOT)!r}) / "scenes" / "paper_curve.toml").read_text()
wheelset_contact(parse_scene(run.replace('model = "condensed"', 'model = "standard"')))
"""
    heavy_after(script)  # generates the code of the friction law from UFL, unless cached
    own = ("models.builders", "elasticity.solid_compliance", "elasticity.waveguide.compliance", "models.lattice.model")
    wrong = [*HEAVY, "wheelrail.forms", *(f"wheelrail.contact.{name}" for name in own)]
    script += f"import sys\nassert not [name for name in {wrong} if name in sys.modules]\n"
    assert heavy_after(script + "solve_contact(scene)\n") == {"xarray"}  # the result is a Dataset


def test_empty_cache_imports_both(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # the check above must be able to fail
    monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path))
    script = """
from wheelrail.contact.laws.parameters import ContactLaws; from wheelrail.contact.laws.material import Material
from wheelrail.contact.elasticity.solid_compliance import solid_compliance
from wheelrail.meshes.bodies.solids import block
from wheelrail.meshes.bodies.triangulation import Grading
import numpy as np
solid, key = block((2, 2), half_width=4.0, grading=Grading(1.0, 1.0))
solid_compliance(solid, key, Material(), 1).block(np.arange(3))
"""
    assert heavy_after(script) >= {"gmsh", "dolfinx", "petsc4py"}
    assert heavy_after(script) == set()


def test_the_vehicle_imports_neither_meshes_nor_finite_elements() -> None:
    """But its wear, which changes profiles and which no run imports."""
    files = [path for path in (ROOT / "vehicle").rglob("*.py") if path.stem != "__init__" and "wear" not in path.parts]
    assert len(files) > 20
    script = "\n".join(f"import wheelrail.{'.'.join(path.relative_to(ROOT).with_suffix('').parts)}" for path in files)
    script += "\nimport sys\nassert not {'wheelrail.meshes', 'wheelrail.forms'} & set(sys.modules)"
    assert heavy_after(script) == set()


def test_help_imports_no_heavy_library() -> None:
    script = """
import contextlib, io
from typer.testing import CliRunner
from wheelrail.cli.main import app
with contextlib.redirect_stdout(io.StringIO()):
    for arguments in (["--help"], ["run", "--help"], ["contact", "--help"]):
        assert CliRunner().invoke(app, arguments).exit_code == 0
import sys
assert "scipy" not in sys.modules and "wheelrail.contact.models.builders" not in sys.modules
"""
    assert heavy_after(script) == set()


class Counter:
    """Counts the calls of functions that it replaces."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.monkeypatch, self.calls = monkeypatch, dict[str, list[Any]]()

    def watch(self, owner: Any, name: str) -> None:
        original, calls = getattr(owner, name), self.calls.setdefault(name, [])

        def counted(*args: Any, **options: Any) -> Any:
            calls.append(args)
            return original(*args, **options)

        self.monkeypatch.setattr(owner, name, counted)


@pytest.fixture
def counter(monkeypatch: pytest.MonkeyPatch) -> Counter:
    return Counter(monkeypatch)


def watch_friction(counter: Counter) -> None:
    counter.watch(tractions_module, "tangential_contact")
    counter.watch(condensed_module, "creepage")
    counter.watch(full_module, "creepage")
    counter.watch(operators_module, "contact_operators")
    counter.watch(SurfaceCompliance, "_fill")


def test_no_tangential_problem_without_friction(counter: Counter) -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty(0.0))
    watch_friction(counter)
    result = model(TOUCHING, CREEP)
    assert result.status == "converged"
    assert not counter.calls["tangential_contact"]
    assert not counter.calls["creepage"]
    couplings = counter.calls["contact_operators"]
    assert len(couplings) == 2
    assert all(order == 0 for *_, order in couplings)
    # and only the compliance along the normal is requested
    assert {direction for _, _, direction in counter.calls["_fill"]} == {2}


def test_tangential_problem_is_solved_and_counted(counter: Counter) -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty())
    watch_friction(counter)
    model(TOUCHING, CREEP)
    assert len(counter.calls["tangential_contact"]) == 1
    assert len(counter.calls["creepage"]) == 1
    assert {direction for _, _, direction in counter.calls["_fill"]} == {0, 1, 2}


def test_full_without_friction_has_normal_unknowns_only(counter: Counter) -> None:
    model = full(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty(0.0))
    watch_friction(counter)
    assert model(TOUCHING, AT_REST).status == "converged"  # nor does it need to roll
    assert not counter.calls["creepage"]
    assert all(order == 0 for *_, order in counter.calls["contact_operators"])
    assert model.law.components == 1


class Untouchable:
    """Raises at any use but the question which ranks it is spread over."""

    ranks = SELF

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"{name} was asked for")


def test_no_solve_without_penetration(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*args: Any, **options: Any) -> Any:
        raise AssertionError("called without an overlap")

    pair = condensed(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty())
    nobody: Any = Untouchable()
    apart = hertz_pose(-1e-6)
    for name in ("pair_operators", "creepage", "solve_tractions", "condense"):
        monkeypatch.setattr(condensed_module, name, never)
    result = type(pair)(pair.geometry, nobody, nobody, ContactLaws.penalty())(apart, CREEP)
    assert result.status == "separated"
    assert result.approach == pytest.approx(-1e-6)
    both = full_module.FullContact(pair.geometry, nobody, nobody, ContactLaws.penalty())
    assert both(apart, CREEP).status == "separated"
    assert "solver" not in vars(both)
    assert "law" not in vars(both)


def test_wheel_above_its_rail_takes_one_projection(counter: Counter) -> None:
    from dataclasses import replace

    from wheelrail.meshes.curves.curve import Curve

    contact = wheelset()
    high = replace(STATE, z=2e-3)
    assert contact(high, "left").status == "separated"  # fills the cache
    counter.watch(Curve, "closest")
    counter.watch(SurfaceCompliance, "block")
    assert contact(high, "right").status == "separated"
    assert not counter.calls["closest"]
    assert not counter.calls["block"]
    assert contact(STATE, "left").ok
    assert len(counter.calls["closest"]) == 1
    assert len(counter.calls["block"]) == 2


def test_stress_is_computed_on_request_only(monkeypatch: pytest.MonkeyPatch) -> None:
    from wheelrail.forms import elasticity

    pair, both = (make(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty()) for make in (condensed, full))
    first = both(TOUCHING, CREEP)  # assembles the stiffness, which needs the stress as a form

    def never(*args: Any) -> Any:
        raise AssertionError("nobody asked for the stress")

    for name in ("stress", "strain"):
        monkeypatch.setattr(elasticity, name, never)
    assert pair(TOUCHING, CREEP).status == "converged"
    again = both(hertz_pose(1.4e-5), CREEP)
    assert again.status == first.status == "converged"
    assert not any("stress" in name for name in vars(again))


def test_compliance_is_assembled_for_candidates_only(counter: Counter) -> None:
    model = condensed(TETRAHEDRA, SPHERE, size=1e-3, laws=ContactLaws.penalty(0.0))
    counter.watch(SurfaceCompliance, "block")
    result = model(TOUCHING, AT_REST)
    assert result.fields is not None
    for _, nodes, directions in counter.calls["block"]:
        np.testing.assert_array_equal(np.sort(nodes), np.sort(result.fields.node))
        assert tuple(directions) == (2,)
