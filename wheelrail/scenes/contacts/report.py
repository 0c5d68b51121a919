"""Report of a contact solution for JSON."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.contacts.side_values import SideValues
from wheelrail.scenes.quantities import AXES, CONTACT, ERRORS, PATCH_FIELDS, TURNS

if TYPE_CHECKING:
    from xarray import Dataset

# Choices of the contact model, by key of the scene.
ELASTIC = ("laws", "bodies", "points", "surface_size")
MODEL_KEYS = {"standard": ("normal", "tangential"), "table": ("table",)}  # of models without elastic bodies
FORCE = tuple(f"{axis}_force" for axis in AXES)
MOMENT = tuple(f"{turn}_moment" for turn in TURNS)


def _unit(names: str | tuple[str, ...]) -> str | list[str]:
    """Unit of a patch quantity, or the units of its components if different."""
    units = [CONTACT[name].unit for name in ([names] if isinstance(names, str) else names)]
    return units if len(set(units)) > 1 else units[0]


# Unit of a number by the innermost key that is here; constants of the user's laws have those of the law.
UNITS: dict[str, str | list[str]] = {
    **{name: error.unit for name, error in ERRORS.items()},
    **{key: _unit(names) for key, names in PATCH_FIELDS.items()},
    **dict.fromkeys(
        ("friction", "share", "newton", "linear", "points", "residual", "contact_solves", "wavenumbers"), "1"
    ),
    **dict.fromkeys(("surface_size", "approach", "z", "depth", "position"), "m"),
    **dict.fromkeys(("stress", "von_mises"), "Pa"),
    "roll": "rad",
    "rate": "s/m",
    "regularisation": "m/s",
    "stiffness_per_area": "N/m3",
    "seconds": "s",
}


def contact_report(data: Dataset) -> dict[str, Any]:
    """Status, choices of the model, constants of the laws, and every side, in SI units.

    Parameters:
        data: Dataset of `wheelrail.scenes.contacts.solution`.

    None stands for a choice or a constant that the model does not have.
    """
    choices = data.attrs
    falling = (
        {"share": choices["falling_share"], "rate": choices["falling_rate"]} if "falling_rate" in choices else None
    )
    return {
        **{key: choices[key] for key in ("status", "kind", "model")},
        "friction": _law(choices["friction"]),
        **{key: choices.get(key) for key in MODEL_KEYS.get(choices["model"], ELASTIC)},
        "falling": falling if "falling_rate" in choices else None,
        "stiffness_per_area": choices.get("stiffness_per_area"),
        **({"normal_law": _law(choices["normal_law"])} if "normal_law" in choices else {}),
        "regularisation": choices["regularisation"],
        **{side: _side(SideValues(data, side)) for side in data["side"].values.tolist()},
    }


def _law(value: float | str) -> Any:
    """Coefficient of friction, or a law and its constants."""
    return json.loads(value) if isinstance(value, str) else value


def _side(own: SideValues) -> dict[str, Any]:
    """Resultants, patches, wheelset position, statistics, error estimate and subsurface stress of one side.

    A failed contact has status and statistics only, a load that cannot be carried the status.
    """
    if not own.placed:
        return {"status": own["status"]}
    if not own.ok:
        return {"status": own["status"], "statistics": _statistics(own)}
    extra: dict[str, Any] = {"unsolved": own.unsolved} if own.unsolved else {}
    if own.error_estimate:
        extra["error_estimate"] = own.error_estimate
    if own.stressed_bodies:
        extra["stress"] = {body: _stress(own, body) for body in own.stressed_bodies}
    return {
        "status": own["status"],
        "force": own.vector(FORCE),
        "moment": own.vector(MOMENT),
        "normal_force": sum(own.by_patch("patch_normal_force")),
        "tangential_force": [sum(own.by_patch(f"patch_{axis}_force")) for axis in AXES[:2]],
        **{name: own[name] for name in ("approach", "z", "roll")},
        "patches": _patches(own),
        **extra,
        "statistics": _statistics(own),
    }


def _patches(own: SideValues) -> list[dict[str, Any]]:
    columns = {
        key: own.by_patch(names) if isinstance(names, str) else list(zip(*map(own.by_patch, names), strict=True))
        for key, names in PATCH_FIELDS.items()
    }
    return [{key: values[k] for key, values in columns.items()} for k in range(own.patches)]


def _statistics(own: SideValues) -> dict[str, Any]:
    """Statistics of the last solve, number of contact solves, and their total computing time."""
    phases = own.data["phase"].values.tolist() if "phase" in own.data else []
    seconds = dict(zip(phases, own["phase_seconds"] if phases else [], strict=True))
    return {
        **{name: own[f"{name}_count"] for name in ("newton", "linear", "points")},
        "residual": own["residual"],
        "seconds": {
            **{phase: value for phase, value in seconds.items() if not math.isnan(value)},
            "all_solves": own["contact_seconds"],
        },
        "contact_solves": own["contact_solves"],
    }


def _stress(own: SideValues, body: str) -> dict[str, Any]:
    """By patch: depth, m, position, m, stress, Pa, von_mises, Pa, with its maximum; wavenumbers and computing time."""
    patches = []
    for k in range(own.patches):
        mises, depth = own.largest_von_mises(body, k)
        patches.append(
            {
                "depth": own.data["depth"].values.tolist(),
                "position": own.below("stress_position", body, k),
                "stress": own.below("stress", body, k),
                "von_mises": own.below("von_mises", body, k),
                "largest": {"von_mises": mises, "depth": depth},
            }
        )
    row = own.data["body"].values.tolist().index(body)
    return {
        "patches": patches,
        "wavenumbers": own["stress_wavenumbers"][row],
        "seconds": own["stress_seconds"][row],
    }
