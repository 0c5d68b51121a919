"""Loading of libraries outside the working directory, whose settings files are not to be read.

With these files a folder from elsewhere could run code: `.petscrc` (`-dll_prepend` loads a library),
`dolfinx_jit_parameters.json` and `ffcx_parameters.json`, from 0.6 on `..._options.json` (arguments of the compiler),
`matplotlibrc` (`backend: module://..` imports a module). The user's own settings, in the home folder and the
environment, remain in effect. A library that was loaded before this package is left as it is.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from types import ModuleType

from wheelrail.support.cache_home import provide_cache_home

ROOT = "/"  # where only an administrator puts files


@contextmanager
def outside_working_directory() -> Iterator[None]:
    """The root as working directory; the present one again afterwards, even if it has been moved or removed."""
    present = os.open(".", getattr(os, "O_PATH", os.O_RDONLY))
    try:
        os.chdir(ROOT)
        yield
    finally:
        os.fchdir(present)
        os.close(present)


def _ffcx() -> None:
    _read_options("ffcx.options", "ffcx.parameters")


def _dolfinx() -> None:
    _read_options("dolfinx.jit")


def _read_options(*modules: str) -> None:
    """Read the options of a library, cached for later calls."""
    module = next(import_module(name) for name in modules if find_spec(name))
    getattr(module, "get_options" if hasattr(module, "get_options") else "get_parameters")()


def _nothing() -> None:
    """No action for PETSc and Matplotlib, which read their files once, at import."""


LIBRARIES: dict[str, Callable[[], None]] = {
    "petsc4py.PETSc": _nothing,
    "ffcx": _ffcx,
    "dolfinx": _dolfinx,
    "matplotlib": _nothing,
}


class _Finder(MetaPathFinder):
    """Finds the libraries where Python does; their modules are executed outside the working directory."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(name, path, target) if name in LIBRARIES else None
        if spec is None or spec.loader is None:
            return None
        execute, settle = spec.loader.exec_module, LIBRARIES[name]

        def execute_outside(module: ModuleType) -> None:
            provide_cache_home()
            with outside_working_directory():
                execute(module)
                settle()

        spec.loader.exec_module = execute_outside  # type: ignore[method-assign]
        return spec


def load_libraries_outside() -> None:
    """Load the libraries outside the working directory from now on, at their first import."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())
