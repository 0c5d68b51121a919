"""Contact solution of a scene as one Dataset: results, poses, shapes of the bodies, stress, computing time."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.scenes.builders.laws import laws
from wheelrail.scenes.contacts.overlaps import unsolved_overlaps
from wheelrail.scenes.contacts.shapes import gap_curvatures, outlines, turns
from wheelrail.scenes.contacts.stress import stress_values
from wheelrail.scenes.datasets.contact import contact_dataset
from wheelrail.scenes.quantities import SOLUTION
from wheelrail.scenes.quantity import filled
from wheelrail.scenes.schema.laws import LawTable
from wheelrail.scenes.schema.profiles import SIDES
from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene
from wheelrail.support.version import commit, versions

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.laws.parameters import ContactLaws
    from wheelrail.scenes.builders.wheelset import SideProfiles
    from wheelrail.scenes.contacts.side_solution import SideSolution


def solution_dataset(
    scene: HertzScene | WheelsetScene,
    solved: Mapping[str, SideSolution],
    profiles: SideProfiles | None = None,
    arguments: Mapping[str, Any] | None = None,
) -> Dataset:
    """Dataset of `contact_dataset` with poses, costs, stresses, profiles, and choices of the scene as attributes.

    Parameters:
        scene: that was solved.
        solved: solution by side.
        profiles: of wheel and inclined rail by side, for a wheelset.
        arguments: of the call, stored as text.

    A choice that the contact model does not have, such as the bodies of the standard model, has no attribute.
    """
    shapes = (scene, solved, profiles or {})
    values = {
        **_poses(solved),
        **_structure(solved),
        "contact_solves": [solution.solves for solution in solved.values()],
        "contact_seconds": [solution.seconds for solution in solved.values()],
        **gap_curvatures(*shapes),
        **turns(*shapes),
        **unsolved_overlaps(*shapes),
        **stress_values(solved),
    }
    bodies = (scene.upper, scene.lower) if isinstance(scene, HertzScene) else (scene, scene)
    upper, lower = ((body.E, body.nu) for body in bodies)
    attributes = dict(
        title="Wheel-rail contact" if profiles else "Contact of a Hertz pair",
        frame="rail frame of each side: x forward, y to the left, z upwards; forces act on the wheel",
        status=_overall({side: solution.result.status for side, solution in solved.items()}),
        kind=scene.kind,
        model=scene.model,
        friction=_law(scene.friction),
        **_of_sides(scene),
        contact_modulus=modulus(upper, lower),
        **({} if isinstance(scene, HertzScene) else {"nominal_radius": scene.wheelset.radius}),
        **_model_choices(scene),
        **_law_constants(scene),
        arguments=json.dumps(dict(arguments or {}), default=str),
        versions=", ".join(f"{name} {number}" for name, number in versions().items()),
        commit=commit(),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    results = {side: solution.result for side, solution in solved.items()}
    variables = filled(SOLUTION, values) | outlines(list(solved), profiles or {})
    return contact_dataset(results, _laws(scene, solved), variables, attributes)


def _laws(scene: HertzScene | WheelsetScene, solved: Iterable[str]) -> dict[str, ContactLaws]:
    """Contact laws by side."""
    return {name: laws(scene, "right" if name == "right" else "left") for name in solved}


def _of_sides(scene: HertzScene | WheelsetScene) -> dict[str, float | str]:
    """Friction and radius (m) by side, if left and right differ."""
    if isinstance(scene, HertzScene) or scene.sides_alike:
        return {}
    tables = {name: scene.side(name) for name in SIDES}
    friction = {f"friction_{name}": _law(table.friction or 0.0) for name, table in tables.items()}
    return {**friction, **{f"radius_{name}": table.radius or 0.0 for name, table in tables.items()}}


def _overall(statuses: Mapping[str, str]) -> str:
    """Status of all sides: the first failure, else "converged", or "separated" without contact."""
    for side, status in statuses.items():
        if status.startswith("failed"):
            return f"failed: {side}: {status.removeprefix('failed').lstrip(': ')}"
    return "converged" if "converged" in statuses.values() else "separated"


def _model_choices(scene: HertzScene | WheelsetScene) -> dict[str, Any]:
    """Choices of the contact model, by key of the scene."""
    if scene.model == "standard":
        return {"normal": scene.normal or "kik-piotrowski", "tangential": scene.tangential or "fastsim"}
    if scene.model == "table":
        return {"table": scene.table}
    how = scene.discretisation
    choices = {"laws": scene.laws, "bodies": how.bodies, "points": how.points, "surface_size": scene.surface_size}
    return {key: value for key, value in choices.items() if value is not None}


def _law(table: float | LawTable) -> float | str:
    """Coefficient of friction, or a law and its constants as JSON."""
    return table if isinstance(table, float | int) else table.model_dump_json()


def _law_constants(scene: HertzScene | WheelsetScene) -> dict[str, float | str]:
    """Constants of the contact laws: penalty, N/m3, or normal law, regularisation, falling friction, 1 and s/m."""
    contact_laws = laws(scene)
    constants: dict[str, float | str] = {"regularisation": contact_laws.regularisation}
    if contact_laws.normal_compliance:
        constants["stiffness_per_area"] = scene.stiffness_per_area
    if scene.normal_law is not None:
        constants["normal_law"] = _law(scene.normal_law)
    if scene.falling is not None:
        constants |= {"falling_share": scene.falling.share, "falling_rate": scene.falling.rate}
    return constants


def _poses(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    """Position of the wheelset, and pose of each wheel in the frame of its rail."""
    origin, rotation = np.full((len(solved), 3), np.nan), np.full((len(solved), 3, 3), np.nan)
    for row, solution in enumerate(solved.values()):
        if solution.pose is not None:
            origin[row], rotation[row] = solution.pose.origin, solution.pose.rotation
    angles = {name: [getattr(solution, name) for solution in solved.values()] for name in ("z", "roll")}
    return {**angles, "wheel_origin": origin, "wheel_rotation": rotation}


def _structure(solved: Mapping[str, SideSolution]) -> dict[str, Any]:
    """Motions of flexible hubs and rails, and stress of a flexible axle."""
    motions = [solution.structure for solution in solved.values()]
    if all(motion is None for motion in motions):
        return {}
    hub, rail = np.full((len(motions), 6), np.nan), np.full((len(motions), 3), np.nan)
    for row, motion in enumerate(motions):
        if motion is not None:
            hub[row], rail[row] = motion.hub, motion.rail
    values: dict[str, Any] = {"hub_motion": hub, "rail_motion": rail}
    axles = [motion.axle for motion in motions if motion is not None and motion.axle is not None]
    if len(axles) == len(motions):
        values |= {"axle_y": axles[0][0], "axle_stress": np.stack([stress for _, stress in axles])}
    return values
