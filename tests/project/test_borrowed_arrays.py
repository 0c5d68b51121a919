"""Compiled functions that do not count references: they return no arrays, and call no function that counts them."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher
from numba.core.errors import NumbaError

from wheelrail.support.compiled import borrowing

ROOT = Path(__file__).parents[2]
# Folders of compiled functions.
COMPILED = ("support", "forms", "meshes", "contact", "vehicle/simulation")


def borrowing_functions() -> list[Any]:
    found = {}
    for folder in COMPILED:
        place = ROOT / ("wheelrail/support" if folder == "support" else folder)
        for path in sorted(place.rglob("*.py")):
            if "borrowing" not in (text := path.read_text()) and "analytic" not in text:
                continue
            parts = path.relative_to(ROOT).with_suffix("").parts
            module = import_module(".".join(parts if parts[0] == "wheelrail" else ("wheelrail", *parts)))
            found |= {id(value): value for value in vars(module).values() if uncounted(value)}
    return list(found.values())


def uncounted(value: object) -> bool:
    return isinstance(value, Dispatcher) and value.targetoptions["_nrt"] is False


def counted(function: Any) -> list[str]:
    """Names of the compiled functions with counts that a function calls."""
    values = {name: function.py_func.__globals__.get(name) for name in function.py_func.__code__.co_names}
    return [name for name, value in values.items() if isinstance(value, Dispatcher) and not uncounted(value)]


def holds_arrays(hint: Any) -> bool:
    fields = get_type_hints(hint).values() if hasattr(hint, "_fields") else get_args(hint)
    return "ndarray" in str(hint) or any(map(holds_arrays, fields))


FUNCTIONS = borrowing_functions()


def test_most_small_functions_borrow() -> None:
    assert len(FUNCTIONS) > 100


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda f: f"{f.py_func.__module__}.{f.py_func.__name__}")
def test_a_borrowing_function_has_no_counts(function: Any) -> None:
    """With mypy's check of the annotation. Of called functions, the counts would be for nothing."""
    assert not counted(function)
    assert not holds_arrays(get_type_hints(function.py_func)["return"])


def test_making_an_array_is_an_error() -> None:
    @borrowing
    def makes(n: int) -> float:
        return float(np.zeros(n)[0])

    with pytest.raises(NumbaError):
        makes(3)
