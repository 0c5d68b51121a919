"""Benchmarks are imported: mypy checks the package alone, and most of them run for too long to be tested."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = sorted(
    ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for file in (ROOT / "benchmarks").rglob("*.py")
    if file.stem not in ("__init__", "__main__")
)


@pytest.mark.parametrize("module", MODULES)
def test_benchmarks_are_imported(module: str) -> None:
    try:
        import_module(module)
    except ModuleNotFoundError as missing:
        if (missing.name or "").startswith(("benchmarks", "wheelrail")):
            raise
        pytest.skip(f"{missing.name} is not installed")
