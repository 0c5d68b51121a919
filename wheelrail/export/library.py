"""The shared library: C functions that start Python and call this package, by cffi's embedding."""

from __future__ import annotations

import json
import logging
import os
import shutil
import subprocess
import sys
import sysconfig
from contextlib import redirect_stdout
from importlib.resources import files
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from wheelrail.export.header import c_header, fortran_module, functions
from wheelrail.export.host import loaded_wheelset
from wheelrail.export.native import copy_library, needs_python, write_native
from wheelrail.export.runtime import export_runtime, write_scene

if TYPE_CHECKING:
    from wheelrail.api.wheelset import Wheelset

log = logging.getLogger(__name__)

EXAMPLES = ("example.c", "example.f90")
SETTINGS = ("WHEELRAIL_CACHE",)  # of the environment, that hosts may set anew
RUNTIME = "runtime"  # folder
KEEP = "-Wl,-z,nodelete"  # Python keeps pointers into the library, also after a program has closed it
_THREADS = """
import os, sys
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
from {module} import ffi, lib
"""
_INSTALLED = """
for name, value in {settings!r}.items():
    os.environ.setdefault(name, value)
path = os.environ.get("WHEELRAIL_PYTHONPATH")
sys.path[:0] = path.split(os.pathsep) if path else {path!r}
"""
_MOVABLE = """
library = os.path.dirname(ffi.string(lib.wheelrail_library()).decode())
runtime = os.path.normpath(os.path.join(library, {runtime!r}))
caches = os.environ.get("WHEELRAIL_CACHE"), os.path.join(runtime, "cache")
os.environ["WHEELRAIL_CACHE"] = os.pathsep.join(filter(None, caches))
sys.path[:0] = [runtime, *filter(None, os.environ.get("WHEELRAIL_PYTHONPATH", "").split(os.pathsep))]
"""
_DEFINE = """
from wheelrail.export.embedded import define
define(ffi)
"""


def export_library(folder: Path, scene: Path | None = None, *, runtime: bool = False) -> Path:
    """Write wheelrail.h, the shared library, a Fortran module and examples into a folder; returns the library's path.

    Parameters:
        folder: is created.
        scene: of a wheelset, which the library solves without Python if it can; otherwise, and without a scene, it
            starts the Python of this installation.
        runtime: whether it starts a Python, whose packages and compliances of the scene are in a runtime folder.

    Raises OSError for a folder that cannot be written, with Python without cffi, a C compiler or Python's headers,
    ValueError as `write_native`, OSError and SceneError as `export_runtime`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "wheelrail.h").write_text(c_header(), encoding="utf-8")
    (folder / "wheelrail.f90").write_text(fortran_module(), encoding="utf-8")
    for name in EXAMPLES:
        (folder / name).write_text(_text(name), encoding="utf-8")
    library = folder / "libwheelrail.so"
    if scene is not None and not runtime:
        wheelset = loaded_wheelset(json.dumps({"scene": scene.name}), scene.parent)
        if is_native(wheelset, library):
            write_native(wheelset, folder)
            copy_library(library)
            return library
        write_scene(scene, folder)
    elif scene is not None:
        write_scene(scene, folder / RUNTIME)
        export_runtime(folder / RUNTIME, folder / RUNTIME)
    compile_library(library, "wheelrail_c", "", RUNTIME if runtime else "")
    return library


def is_native(wheelset: Wheelset, made: Path) -> bool:
    """Whether the contact of a wheelset is solved without Python, which is logged for the file that is made."""
    if python := needs_python(wheelset):
        log.info("%s starts Python, which solves %s", made.name, python)
    else:
        log.info("%s needs no Python", made.name)
    return not python


def compile_library(library: Path, module: str, source: str, runtime: str = "") -> None:
    """Compile the library.

    Parameters:
        library: file to write.
        module: name of the Python module inside, unique among the libraries of a process.
        source: further C code that uses the functions of the header.
        runtime: path of a runtime folder from the library's folder, or empty.

    With a runtime folder the library can be moved with it. Without one the library finds Python's packages where this
    process does; the environment variable WHEELRAIL_PYTHONPATH names other folders. Raises OSError.
    """
    if sys.platform != "linux":
        raise OSError(f"libraries for other programs are made on Linux only so far, not on {sys.platform}")
    try:
        from cffi import FFI
    except ImportError:
        raise OSError("cffi is not installed; install wheelrail[export]") from None
    ffi = FFI()
    ffi.embedding_api(functions().replace("int wheelrail_version(void);", "").replace("_open(", "_python_open("))
    libpython = f'#define LIBPYTHON "{sysconfig.get_config_var("INSTSONAME")}"'
    ffi.cdef("const char *wheelrail_library(void);")
    ffi.set_source(module, "\n".join((libpython, c_header(), _text("python.c"), source)))
    place = _MOVABLE.format(runtime=runtime) if runtime else _installed()
    ffi.embedding_init_code(_THREADS.format(module=module) + place + _DEFINE)
    with TemporaryDirectory() as work:
        code = Path(work, "library.c")
        with redirect_stdout(StringIO()):  # cffi prints the name of the file
            ffi.emit_c_code(str(code))
        _compile(code, library, movable=bool(runtime))


def _installed() -> str:
    """Python code that finds this installation's packages and caches."""
    settings = {name: str(Path(os.environ[name]).absolute()) for name in SETTINGS if os.environ.get(name)}
    path = [str(Path(entry).absolute()) for entry in sys.path if entry and Path(entry).exists()]
    return _INSTALLED.format(settings=settings, path=[str(Path(__file__).parents[2]), *path])


def _text(name: str) -> str:
    return files("wheelrail.export").joinpath(name).read_text(encoding="utf-8")


def _compile(code: Path, library: Path, movable: bool) -> None:
    """Compile a C file into a shared library linked with Python's.

    Parameters:
        code, library: file to read and file to write.
        movable: the system finds Python's library, on another machine perhaps elsewhere than here.

    Raises OSError with the compiler's first error.
    """
    compiler = os.environ.get("CC", "cc")
    if shutil.which(compiler) is None:
        raise OSError(f"C compiler {compiler!r}: not found; install one, or name it by the environment variable CC")
    place, version = sysconfig.get_config_var("LIBDIR"), sysconfig.get_config_var("LDVERSION")
    command = [compiler, "-O2", "-shared", "-fPIC", f"-I{sysconfig.get_path('include')}", str(code), "-o", str(library)]
    command += [f"-L{place}", f"-lpython{version}", "-ldl", "-lpthread", KEEP]
    command += [] if movable else [f"-Wl,-rpath,{place}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        error = next((line for line in done.stderr.splitlines() if "error" in line), done.stderr.strip())
        raise OSError(f"{compiler}: {error}")
