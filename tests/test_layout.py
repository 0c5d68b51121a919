"""Imports point one way, from meshes to the public package; heavy libraries stay where they are needed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAY_IMPORT = {
    "meshes": {"meshes"},
    "forms": {"forms"},
    "contact": {"meshes", "forms", "contact"},
    "vehicle": {"contact", "vehicle"},  # one call drives a contact model: no meshes, no forms
    "scenes": {"meshes", "contact", "vehicle", "scenes"},
    "wheelrail": {"meshes", "contact", "vehicle", "scenes", "wheelrail"},
}
ELEMENTS = {"dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py"}
HEAVY = ELEMENTS | {"gmsh", "pyvista", "xarray", "matplotlib", "netCDF4"}
FILES = sorted(path for package in MAY_IMPORT for path in (ROOT / package).rglob("*.py"))


def imports(node: ast.AST, *, nested: bool) -> Iterator[str]:
    """Names of imported modules; not nested: only those that importing the file imports."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import):
            yield from (alias.name for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            assert child.level == 0, "relative imports hide where they point"
            assert child.module is not None
            yield child.module
        elif isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and not nested:
            continue
        elif isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test) and not nested:
            yield from (name for part in child.orelse for name in imports(ast.Module([part], []), nested=nested))
        else:
            yield from imports(child, nested=nested)


def roots(path: Path, *, nested: bool) -> set[str]:
    return {name.split(".")[0] for name in imports(ast.parse(path.read_text()), nested=nested)}


def test_there_are_files_of_every_package() -> None:
    assert {path.relative_to(ROOT).parts[0] for path in FILES} == set(MAY_IMPORT)
    assert len(FILES) > 50


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_point_one_way(path: Path) -> None:
    package = path.relative_to(ROOT).parts[0]
    foreign = (roots(path, nested=True) & set(MAY_IMPORT)) - MAY_IMPORT[package]
    assert not foreign


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_heavy_libraries_stay_where_they_belong(path: Path) -> None:
    package = path.relative_to(ROOT).parts[0]
    anywhere, at_once = roots(path, nested=True) & HEAVY, roots(path, nested=False) & HEAVY
    assert "gmsh" not in at_once
    assert "pyvista" not in at_once
    if package == "vehicle":
        assert not anywhere
    if package == "meshes":
        assert anywhere <= {"gmsh"}
    if package in ("scenes", "wheelrail"):
        assert not anywhere & ELEMENTS
    if package in ("forms", "contact"):
        assert anywhere <= ELEMENTS
    if path.name in ("condensed.py", "compliance.py", "pairs.py", "points.py", "tractions.py", "wheelrail.py"):
        assert not at_once


def test_differences_between_versions_live_in_one_file() -> None:
    asking = [path for path in FILES if "dolfinx.__version__" in path.read_text()]
    assert [path.name for path in asking] == ["compat.py"]


def test_the_check_sees_what_it_should(tmp_path: Path) -> None:
    file = tmp_path / "sample.py"
    file.write_text(
        "from typing import TYPE_CHECKING\nimport numpy\nif TYPE_CHECKING:\n    import gmsh\n"
        "def f():\n    from scenes.cli import app\nclass A:\n    import dolfinx.fem\n"
    )
    assert roots(file, nested=True) == {"typing", "numpy", "gmsh", "scenes", "dolfinx"}
    assert roots(file, nested=False) == {"typing", "numpy", "dolfinx"}
