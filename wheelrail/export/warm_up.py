"""A contact of a wheelset that reads all that later solves need: compliances and laws."""

from __future__ import annotations

from pathlib import Path

from wheelrail.export.host import loaded_inputs, loaded_wheelset
from wheelrail.scenes.schema.errors import SceneError

SCENE = "scene.toml"
DEPTHS = (5e-6, 1e-4)  # m, of both wheels in their rails, of S1002 on 60E1 some 0.5 kN, on narrower strips, and 50 kN


def warm_up(folder: Path) -> None:
    """Solve both contacts of a wheelset, under its load and at two heights, with tangent and patches.

    Parameters:
        folder: that of its scene.toml.

    Raises SceneError for a contact that fails and for a scene that is no wheelset, ImportError without the packages
    that the model needs.
    """
    wheelset = loaded_wheelset(f'{{"scene": "{SCENE}"}}', folder)
    loaded_inputs(wheelset)
    element = wheelset.element()
    start = element.solve()
    lift = min(start.approach.values())
    for depth in DEPTHS:
        solution = element.solve(z=start.state.z + lift - depth)
        if solution.status != "converged":
            raise SceneError(f"the contact of the scene cannot be solved: {solution.status}")
    if wheelset.arguments.get("model") != "standard":
        element.tangent()
    element.patches()
