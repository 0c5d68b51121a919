"""Directions of imports, no circular imports, and heavy libraries in few modules only."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Iterator, Mapping
from functools import cache
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCIENCE = ("contact", "forms", "meshes", "vehicle")
# Packages that a package may import besides its own; a name stands for the package and its subpackages alike.
MAY_IMPORT: dict[str, set[str]] = {
    "bindings": set(),
    "support": {"bindings"},  # options of the C compiler are those of the build
    "forms": {"support"},
    "meshes": {"meshes.bodies", "meshes.curves", "meshes.profiles"},
    "meshes.curves": {"support"},
    "meshes.profiles": {"meshes.curves", "support"},
    "meshes.bodies": {"meshes.curves", "meshes.profiles", "support"},
    "contact": {"contact.element", "contact.kinematics", "contact.laws", "contact.loading", "contact.models"}
    | {
        "contact.models.full",
        "contact.models.lattice",
        "contact.models.standard",
        "contact.results",
        "contact.solvers",
    },
    "contact.analytical": {"support"},
    "contact.kinematics": {"meshes.curves", "support"},
    "contact.laws": {"forms", "support"},  # laws in UFL, imported where a law is first compiled
    "contact.geometry": {"contact.kinematics", "meshes.bodies", "meshes.curves", "meshes.profiles", "support"},
    "contact.results": {"contact.geometry", "contact.kinematics", "support"},
    "contact.element": {"contact.kinematics", "contact.results", "support"},
    "contact.solvers": {"contact.kinematics", "contact.laws", "support"},
    "contact.elasticity": {"contact.geometry", "contact.laws", "forms", "meshes.bodies", "support"},
}
MAY_IMPORT["contact.elasticity.waveguide"] = MAY_IMPORT["contact.elasticity"] | {
    "contact.elasticity",
    "contact.kinematics",
}
MAY_IMPORT["contact.structure"] = MAY_IMPORT["contact.elasticity.waveguide"] | {"contact.elasticity.waveguide"}
_MODEL = {"contact.geometry", "contact.kinematics", "contact.laws", "contact.results", "support"}
MAY_IMPORT |= {
    "contact.models.standard": _MODEL | {"contact.analytical", "contact.solvers", "meshes.curves"},
    "contact.models.full": _MODEL | {"contact.elasticity", "contact.solvers", "forms", "meshes.bodies"},
    "contact.models.table": _MODEL | {"contact.solvers"},
    "contact.models.lattice.influence": _MODEL
    | {"contact.elasticity", "contact.elasticity.waveguide", "contact.solvers", "meshes.curves", "meshes.profiles"},
}
_LATTICE = MAY_IMPORT["contact.models.lattice.influence"]
for _index, _name in enumerate(("influence", "system", "")):
    _lower = {f"contact.models.lattice.{lower}" for lower in ("influence", "system")[:_index]}
    MAY_IMPORT[f"contact.models.lattice.{_name}".rstrip(".")] = _LATTICE | _lower
MAY_IMPORT["contact.models"] = {
    "contact.analytical",
    "contact.elasticity.waveguide",
    *(f"contact.models.{name}" for name in ("full", "lattice", "standard", "table")),
    *(MAY_IMPORT["contact.models.lattice"] | MAY_IMPORT["contact.models.full"]),
}
MAY_IMPORT |= {
    "contact.loading": {"contact.geometry", "contact.kinematics", "contact.models", "contact.results", "support"}
    | {"contact.models.standard", "contact.solvers", "contact.structure"},
    "contact.tables": {"contact.kinematics", "contact.laws", "contact.loading", "contact.models.table"}
    | {"contact.results", "support"},
    "contact.stress": MAY_IMPORT["contact.models"] | {"contact.models"},
    "contact.wear": {"contact.laws", "contact.results", "contact.stress", "meshes.profiles", "support"},
    "vehicle": {f"vehicle.{name}" for name in ("loads", "multibody", "simulation", "steady", "track", "wagon")},
    "vehicle.wagon": {"support"},
    "vehicle.loads": {"support"},
    "vehicle.evaluation": {"contact.kinematics", "support"},
    "vehicle.integration": {"support"},
    "vehicle.wear": {f"contact.{name}" for name in ("kinematics", "laws", "results", "wear")}
    | {"meshes.profiles", "support"},
    "vehicle.track": {"bindings", "contact.kinematics", "support"},
}
# One call drives a contact model: no meshes, no elements.
_DRIVEN = {
    "contact.element",
    "contact.kinematics",
    "contact.loading",
    "contact.results",
    "support",
    "vehicle.integration",
    "vehicle.loads",
    "vehicle.track",
    "vehicle.wagon",
}
MAY_IMPORT |= {
    "vehicle.multibody": _DRIVEN | {"bindings"},
    "vehicle.steady": _DRIVEN | {"vehicle.multibody"},
    "vehicle.simulation": _DRIVEN | {"vehicle.multibody", "vehicle.steady"},
    "vehicle.crosswind": _DRIVEN | {"vehicle.evaluation", "vehicle.multibody", "vehicle.simulation", "vehicle.steady"},
}
_BELOW = {name for name in MAY_IMPORT if name.split(".")[0] != "forms"}
_SCENES = (
    "schema",
    "datasets",
    "builders",
    "contacts",
    "plots",
    "runs",
    "views",
    "studies",
    "wear",
    "assessment",
    "tables",
    "html_report",
)
MAY_IMPORT["scenes"] = {"contact.results", "scenes.schema"}
MAY_IMPORT["scenes.schema"] = {
    "contact.laws",
    "contact.models",
    "meshes.profiles",
    "vehicle.loads",
    "vehicle.track",
    "vehicle.wagon",
    "support",
}
for _index, _name in enumerate(_SCENES[1:], 1):
    MAY_IMPORT[f"scenes.{_name}"] = _BELOW | {"scenes", *(f"scenes.{lower}" for lower in _SCENES[:_index])}
MAY_IMPORT["cli"] = _BELOW | {"export", "scenes"} | {f"scenes.{name}" for name in _SCENES}
MAY_IMPORT["export"] = {"api", "api.elements", "scenes.schema", "support"}
MAY_IMPORT["export"] |= {f"contact.{name}" for name in ("element", "geometry", "kinematics", "laws", "models")}
MAY_IMPORT["export"] |= {
    "bindings",
    "contact.loading",
    "contact.models.lattice",
    "contact.models.standard",
    "scenes.builders",
}
MAY_IMPORT["api"] = _BELOW | {"api.elements", "scenes", *(f"scenes.{name}" for name in _SCENES)}
_OF_CONTACT = {f"contact.{name}" for name in ("element", "kinematics", "loading", "models", "results")}
MAY_IMPORT["api.elements"] = _OF_CONTACT | {"scenes.schema", "support"}
MAY_IMPORT["explorer"] = MAY_IMPORT["api"] | {"api"}
MAY_IMPORT["cli"] |= {"explorer"}
MAY_IMPORT[""] = {"api", "api.elements", "explorer", "scenes.schema", "support"}

ELEMENTS = {"dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py"}
HEAVY = ELEMENTS | {"gmsh", "pyvista", "xarray", "matplotlib", "netCDF4"}
# Modules that a solve from the cache loads: finite elements are imported where they are first used.
LOADED_BY_EVERY_SOLVE = (
    "contact/models/condensed.py",
    "contact/elasticity/solid_compliance.py",
    "contact/models/builders.py",
    "contact/models/profile_bodies.py",
    "contact/geometry/grid_points.py",
    "contact/solvers/tractions.py",
    "contact/geometry/profile_pair.py",
)


def _sources() -> Iterator[Path]:
    """Every module of the package by name, each once, as `wheelrail/` has links to other folders."""
    for top in (*SCIENCE, "wheelrail"):
        for folder, _, names in os.walk(ROOT / top):  # which does not follow links
            yield from (Path(folder, name) for name in names if name.endswith(".py"))


FILES = sorted(_sources())


def module_of(path: Path) -> str:
    """Name of a module below `wheelrail`, "" for the public package itself."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    parts = parts[1:] if parts[0] == "wheelrail" else parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def package_of(path: Path) -> str:
    name = module_of(path)
    return name if path.stem == "__init__" else name.rpartition(".")[0]


MODULES = {module_of(path): path for path in FILES}


def imports(node: ast.AST, *, nested: bool) -> Iterator[str]:
    """Names of imported modules; not nested: only those that importing the file imports."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from (alias.name for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            assert child.level == 0, "relative imports hide where they point"
            assert child.module is not None
            yield child.module
            yield from (f"{child.module}.{alias.name}" for alias in child.names)
        elif isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and not nested:
            continue
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test) and not nested:
            yield from (name for part in child.orelse for name in imports(ast.Module([part], []), nested=nested))
        else:
            yield from imports(child, nested=nested)


@cache
def imported(path: Path, *, nested: bool) -> frozenset[str]:
    return frozenset(imports(ast.parse(path.read_text(encoding="utf-8")), nested=nested))


def roots(path: Path, *, nested: bool) -> set[str]:
    return {name.split(".")[0] for name in imported(path, nested=nested)}


def ours(path: Path) -> set[str]:
    """Modules of the package that a module imports anywhere, for type checking included; packages by their face."""
    names = {
        name.removeprefix("wheelrail").lstrip(".")
        for name in imported(path, nested=True)
        if name.startswith("wheelrail")
    }
    modules = names & set(MODULES)
    return modules - {name for name in modules if any(other.startswith(f"{name}.") for other in modules)} - {""}


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """Modules that import one another in a circle, none where there is no circle."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_package_has_its_rule() -> None:
    assert len(FILES) > 250
    assert {package_of(path) for path in FILES} == set(MAY_IMPORT)


def test_imports_point_one_way() -> None:
    for path in FILES:
        package = package_of(path)
        packages = {package_of(MODULES[name]) for name in ours(path)}
        assert not packages - MAY_IMPORT[package] - {package}, path


def test_no_circular_imports_of_modules() -> None:
    assert circle({name: ours(path) - {name} for name, path in MODULES.items()}) == []


def test_no_circular_imports_of_packages() -> None:
    graph: dict[str, set[str]] = {package: set() for package in MAY_IMPORT}
    for path in FILES:
        if path.stem != "__init__":
            graph[package_of(path)] |= {package_of(MODULES[name]) for name in ours(path)} - {package_of(path)}
    assert circle(graph) == []


def levels(top: str) -> list[list[str]]:
    """Packages of a folder by the rules, each level above those that it imports."""
    below: dict[str, set[str]] = {}
    for package, allowed in MAY_IMPORT.items():
        if (name := package.partition(".")[2].partition(".")[0]) and package.startswith(f"{top}."):
            others = {other.split(".")[1] for other in allowed if other.startswith(f"{top}.")}
            below.setdefault(name, set()).update(others - {name})
    sorter = TopologicalSorter(below)
    sorter.prepare()
    found = []
    while sorter.is_active():
        found.append(sorted(sorter.get_ready()))
        sorter.done(*found[-1])
    return found


@pytest.mark.parametrize("top", ["meshes", "contact", "vehicle", "scenes"])
def test_contributing_lists_the_levels(top: str) -> None:
    row = " → ".join(", ".join(f"`{name}`" for name in level) for level in levels(top))
    assert f"| `{top}` | {row} |" in (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()


def test_contributing_says_where_things_are() -> None:
    """A row's first file has a path, the others next to it may go without."""
    table = (
        (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("| where is | file |")[2].partition("\n\n")[0]
    )
    rows = [re.findall(r"`([\w/]+\.\w+)`", row) for row in table.splitlines()[2:]]
    assert len(rows) > 8
    for row in rows:
        places = {ROOT, *((ROOT / name).parent for name in row)}
        assert not [name for name in row if not any((place / name).exists() for place in places)]


def test_own_imports_are_absolute() -> None:
    relative = {*SCIENCE, "scenes", "support", "api", "cli", "benchmarks", "tests"}
    assert [path for path in FILES if roots(path, nested=True) & relative] == []


def heavy_imports_allowed(top: str) -> set[str]:
    """Heavy libraries that modules below a folder may import."""
    if top == "vehicle":
        return set()
    if top == "meshes":
        return {"gmsh"}
    if top in ("scenes", "cli", "api", "explorer", "export", ""):
        return HEAVY - ELEMENTS
    return ELEMENTS if top in ("forms", "contact", "support") else HEAVY


def test_heavy_libraries_are_imported_by_few_modules() -> None:
    for path in FILES:
        assert not roots(path, nested=False) & {"gmsh", "pyvista"}, path
        anywhere = roots(path, nested=True) & HEAVY
        assert anywhere <= heavy_imports_allowed(module_of(path).split(".")[0]), path


@pytest.mark.parametrize("name", LOADED_BY_EVERY_SOLVE)
def test_a_solve_from_the_cache_loads_no_heavy_library(name: str) -> None:
    assert not roots(ROOT / name, nested=False) & HEAVY


CORE = sorted(
    file for top in (*SCIENCE, "wheelrail/support", "wheelrail/export") for file in (ROOT / top).glob("**/core/*.hpp")
)


def test_headers_of_the_core_know_no_python() -> None:
    for path in CORE:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"nanobind|Python\.h|PyObject", text), path
        assert len(text.splitlines()) <= 300, path
        assert "\n#pragma once\n" in text, path
        assert text.startswith("// "), path


def test_bindings_are_short() -> None:
    assert len(CORE) > 8
    sources = list((ROOT / "bindings").glob("*.cpp"))
    assert sources
    assert all(len(source.read_text(encoding="utf-8").splitlines()) <= 300 for source in sources)


def test_version_differences_are_in_one_file() -> None:
    asking = [path for path in FILES if "dolfinx.__version__" in path.read_text(encoding="utf-8")]
    assert [path.name for path in asking] == ["compat.py"]


@pytest.mark.parametrize("package", sorted(MAY_IMPORT))
def test_packages_have_docstrings_and_at_most_15_modules(package: str) -> None:
    (init,) = (path for path in FILES if path.stem == "__init__" and module_of(path) == package)
    assert ast.get_docstring(ast.parse(init.read_text(encoding="utf-8")))
    modules = [path for path in FILES if package_of(path) == package and path.stem not in ("__init__", "__main__")]
    assert len(modules) <= 15


PRONOUN = re.compile(r"\b(those|these|what|it|others|they|them)\b", re.IGNORECASE)


def test_docstrings_begin_with_a_short_sentence_without_pronoun() -> None:
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef
    for path in FILES:
        nodes = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, kinds)]
        for node in nodes:
            first = re.split(r"(?<=[.;:])\s", " ".join((ast.get_docstring(node) or "").split()))[0]
            assert len(first.split()) <= 25, (path, first)
            assert not PRONOUN.search(first), (path, first)


@pytest.mark.parametrize("package", sorted(MAY_IMPORT))
def test_no_public_name_of_a_package_hides_one_of_its_modules(package: str) -> None:
    (init,) = (path for path in FILES if path.stem == "__init__" and module_of(path) == package)
    names = set(import_module(f"wheelrail.{package}".rstrip(".")).__dict__.get("__all__", ()))
    inside = {path.stem for path in init.parent.iterdir() if path.suffix == ".py" or path.is_dir()}
    assert not names & inside


def test_the_import_check_detects_violations(tmp_path: Path) -> None:
    file = tmp_path / "sample.py"
    file.write_text(
        "from typing import TYPE_CHECKING\nimport numpy\nif TYPE_CHECKING:\n    import gmsh\n"
        "def f():\n    from wheelrail.vehicle.track import track\nclass A:\n    import dolfinx.fem\n"
    )
    assert roots(file, nested=True) == {"typing", "numpy", "gmsh", "wheelrail", "dolfinx"}
    assert roots(file, nested=False) == {"typing", "numpy", "dolfinx"}
    assert ours(file) == {"vehicle.track.track"}
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"a"}})
    assert not circle({"a": {"b", "c"}, "b": {"c"}})
