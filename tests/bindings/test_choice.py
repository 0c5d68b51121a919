"""Choice of the build of the compiled core, and refusal of an old one."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from wheelrail import bindings


def test_a_build_is_chosen_by_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WHEELRAIL_CORE", "/other")
    assert bindings.build() == Path("/other")
    monkeypatch.delenv("WHEELRAIL_CORE")
    assert bindings.build() in {bindings.HERE / "baseline", bindings.HERE / "x86-64-v3"}


def test_a_missing_core_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(ImportError, match=r"the compiled core is missing in .*: make core"):
        bindings.require_built(tmp_path)


def test_a_core_older_than_a_source_is_refused(tmp_path: Path) -> None:
    module, header = tmp_path / "_vehicle.so", bindings.HERE.parent / "support" / "core" / "dual.hpp"
    module.touch()
    bindings.require_built(tmp_path)
    os.utime(module, (0.0, header.stat().st_mtime - 1.0))
    with pytest.raises(ImportError, match=r"\.(hpp|cpp) is newer than the compiled core: make core"):
        bindings.require_built(tmp_path)
