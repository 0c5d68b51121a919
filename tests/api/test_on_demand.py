"""Equivalent conicities are computed when they are read, once."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.api import contact_geometry as module


def test_conicity_is_computed_when_it_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []

    def conicity(wheelset: object, amplitude: np.ndarray, difference_at: object) -> np.ndarray:
        calls.append(len(amplitude))
        return 10.0 * amplitude

    monkeypatch.setattr(module, "wheelset_conicity", conicity)
    found = wr.contact_geometry(y=[-1e-3, 1e-3, 2e-3])
    assert found.sizes["amplitude"] == 2
    assert "equivalent_conicity" in repr(found)
    assert calls == []
    conicities = found["equivalent_conicity"]
    np.testing.assert_array_equal(conicities.values, [0.01, 0.02])
    np.testing.assert_array_equal(conicities.values, [0.01, 0.02])
    assert float(found["equivalent_conicity"].sel(amplitude=2e-3)) == 0.02
    assert calls == [2]
    copy = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(copy["equivalent_conicity_with_roll"], [0.01, 0.02])
    np.testing.assert_array_equal(found.copy(deep=True)["equivalent_conicity_with_roll"], [0.01, 0.02])
