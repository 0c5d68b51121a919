"""Notebook 13: the page of the notebook shows the contact that its cells solve."""

from __future__ import annotations

import numpy as np
from notebook_runner import executed


def test_notebook_explores() -> None:
    names = executed("13_explore.py", RESOLUTION={"strips": 6, "cells": 8})
    assert names["page"].url.startswith("http://127.0.0.1:")
    assert '<iframe src="http://127.0.0.1:' in names["page"]._repr_html_()
    assert names["solution"].ok
    assert np.abs(names["forces"] + names["forces"][::-1, ::-1]).max() < 1e-6 * 57e3  # mirror image
    names["page"].close()
