"""The C library, driven by programs without Python: numbers of the element to the last bit, errors as text."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.api.elements.variables import INPUTS, OUTPUTS
from wheelrail.cli.main import app
from wheelrail.export.header import c_header
from wheelrail.export.host import loaded_inputs

pytest.importorskip("cffi")
if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

HERE = Path(__file__).parent
SCENES = HERE.parents[1] / "scenes"
PAIR: dict[str, Any] = {"wheel": "S1002", "rail": "UIC60-benchmark", "speed": 20.0}
LATTICE = {**PAIR, "bodies": "half-space", "strips": 8, "cells": 8}
STANDARD = {**PAIR, "model": "standard", "left": {"friction": 0.1}}
PLACES = ((-1e-3, -2.8e-4), (-1.2e-3, -2.7e-4), (-1.4e-3, -2.6e-4))  # of host.c


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The exported files."""
    folder = tmp_path_factory.mktemp("library")
    wr.Wheelset(**STANDARD).element().solve(z=-2.5e-4)  # machine code is in the cache before programs need it
    exported = CliRunner().invoke(app, ["export", "--c", str(folder)])
    assert exported.exit_code == 0, exported.stderr
    assert exported.stdout.replace("\n", "") == str(folder / "libwheelrail.so")
    return folder


def built(folder: Path, compiler: str, *sources: str) -> Path:
    program = folder / f"{Path(sources[-1]).stem}_{compiler}"
    link = ["-L.", "-lwheelrail", "-Wl,-rpath,$ORIGIN", "-lm", "-lpthread", "-o", str(program)]
    subprocess.run([compiler, "-Wall", "-I.", *sources, *link], cwd=folder, check=True, timeout=60)
    return program


def output(program: Path, *arguments: str, **settings: str) -> list[str]:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | settings
    done = subprocess.run(
        [program, *arguments], capture_output=True, text=True, timeout=300, env=environment, check=False, cwd="/"
    )
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    return done.stdout.splitlines()


def numbers(wheelset: wr.Wheelset) -> list[float]:
    """What host.c prints of an element."""
    values: list[float] = []
    element, outputs, inputs = wheelset.element(), np.zeros(len(OUTPUTS)), loaded_inputs(wheelset)
    for inputs[0], inputs[1] in PLACES:
        assert element.solve_array(inputs, outputs) == "converged"
        values += [*outputs, *element.tangent_array([3])[:, 0], *element.patch_array().ravel()]
        element.accept()
    return values


def test_a_host_in_c(folder: Path) -> None:
    expected = numbers(wr.Wheelset(**LATTICE))
    program = built(folder, "cc", str(HERE / "host.c"))
    first, second, *errors = output(program, json.dumps(LATTICE), json.dumps(STANDARD))
    assert [float.fromhex(text) for text in first.split()] == expected
    assert second == first  # another element in another thread
    assert errors == [
        *(
            text[:59]
            for text in (
                "failed: z = nan: must be a number from -0.1 to 0.1 m (2 mm is 0.002)",
                "failed: left: the wheel lies inside the rail, too deep for a contact",
                "failed: left: friction needs a positive rolling speed, got -0 m/s",
                "failed: y = 1e+300: must be a number from -0.1 to 0.1 m (2 mm is 0.002)",
            )
        ),
        "1.14000e+05",
        "Wheelset: friction = -1: must be a number from 0 to 2 (0 skips the tangential problem)",
        "Expecting property name enclosed in double quotes: line 1 column 2 (char 1)",
        "none.toml: cannot be read: No such file or directory; allowed: a text file of at most 1 MB",
        "3 11 -1",
        "element 3: not open",
    ]


def test_the_examples(folder: Path) -> None:
    """Both programs, compiled as their first lines say, beside the element."""
    options = json.dumps(STANDARD)
    last = [float(line) for line in output(built(folder, "cc", "example.c"), options)]
    assert last[2] + last[8] == pytest.approx(164e3, rel=0.01)  # the wheelset falls for 1 ms
    if shutil.which("gfortran") is None:
        pytest.skip("no Fortran compiler")
    wheelset, outputs = wr.Wheelset(**STANDARD), np.zeros(len(OUTPUTS))
    wheelset.element().solve_array(loaded_inputs(wr.Wheelset(**STANDARD, wheel_load=50e3)), outputs)
    program = built(folder, "gfortran", "wheelrail.f90", "example.f90")
    found = [float(line) for line in output(program, options)]
    assert [found[2], found[8]] == pytest.approx([50e3, 50e3], rel=1e-6)
    assert found == pytest.approx(outputs.tolist(), rel=1e-6)  # from another start


def test_finite_elements_are_not_needed_at_run_time(folder: Path) -> None:
    """Without dolfinx, PETSc and MPI (UFL remains), in other folders of Python packages than those of the export."""
    without = folder / "without"
    without.mkdir()
    for name in ("dolfinx", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh"):
        (without / f"{name}.py").write_text(f"raise ImportError('{name} is not installed')")
    path = os.pathsep.join([str(without), str(HERE.parents[1]), *filter(None, sys.path)])
    program, options = built(folder, "cc", "example.c"), json.dumps(STANDARD)
    assert output(program, options, WHEELRAIL_PYTHONPATH=path) == output(program, options)
    (without / "numpy.py").write_text("raise ImportError('numpy is not installed')")  # the folder is read
    with pytest.raises(AssertionError, match="numpy is not installed"):
        output(program, options, WHEELRAIL_PYTHONPATH=path)


def test_header_and_module_have_the_numbers_of_the_table(folder: Path) -> None:
    names = re.findall(r"WHEELRAIL_IN_(\w+),", c_header())
    assert names == [variable.name.upper() for variable in INPUTS]
    module = (folder / "wheelrail.f90").read_text(encoding="utf-8")
    assert re.findall(r"parameter :: OUT_(\w+) = (\d+)", module) == [
        (variable.name, str(number)) for number, variable in enumerate(OUTPUTS, 1)
    ]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "export: exactly one of --out DIR, --fmu FILE, --c DIR and --csv FILE is required"),
        (["--fmu", "x.fmu"], "export: SCENE is required"),
        ([str(SCENES / "wheelset.toml"), "--fmu", "x.zip"], "--fmu x.zip: must end in .fmu"),
        ([str(SCENES / "hertz.toml"), "--fmu", "x.fmu"], f'{SCENES / "hertz.toml"}: kind = "hertz": must be'),
        (["--c", str(SCENES / "hertz.toml")], f"--out {SCENES / 'hertz.toml'}: "),
    ],
)
def test_wrong_arguments(arguments: list[str], says: str) -> None:
    outcome = CliRunner().invoke(app, ["export", *arguments])
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith(says)


def test_without_a_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    outcome = CliRunner().invoke(app, ["export", "--c", str(tmp_path / "out")])
    assert outcome.exit_code == 1
    assert "C compiler 'no-such-compiler': not found" in outcome.stderr
