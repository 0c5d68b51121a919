"""Report of a contact solve, as JSON and as a table."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType

    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.subsurface import SubsurfaceStress


def side_report(
    result: ContactResult,
    *,
    z: float,
    roll: float,
    solves: int,
    seconds: float,
    stress: Mapping[str, SubsurfaceStress] | None = None,
) -> dict[str, Any]:
    """Report of one side: resultants, patches, wheelset position, statistics, error estimate and subsurface stress.

    Parameters:
        result: of the last solve, whose statistics are reported.
        z: height of the wheelset above its nominal height, m.
        roll: of the wheelset, rad.
        solves: contact solves for the load, in total.
        seconds: their computing time.
        stress: subsurface stress by body.

    A failed contact reports status and statistics only.
    """
    tangential = [sum(patch.tangential_force[i] for patch in result.patches) for i in (0, 1)]
    statistics = asdict(result.statistics)
    cost = {**statistics, "contact_solves": solves, "seconds": {**statistics["seconds"], "all_solves": seconds}}
    if not result.ok:
        return {"status": result.status, "statistics": cost}
    extra: dict[str, Any] = {}
    if result.error_estimate is not None:
        extra["error_estimate"] = asdict(result.error_estimate)
    if stress:
        extra["stress"] = {name: stress_report(body_stress) for name, body_stress in stress.items()}
    return {
        "status": result.status,
        "force": result.force,
        "moment": result.moment,
        "normal_force": sum(patch.normal_force for patch in result.patches),
        "tangential_force": tangential,
        "approach": result.approach,
        "z": z,
        "roll": roll,
        "patches": [asdict(patch) for patch in result.patches],
        **extra,
        "statistics": cost,
    }


def stress_report(stress: SubsurfaceStress) -> dict[str, Any]:
    """By patch: depth, m, position, m, stress, Pa, von_mises, Pa, with its maximum; wavenumbers and computing time."""
    patches = []
    for patch in stress.patches:
        mises = patch.von_mises
        maximum = int(mises.argmax())
        patches.append(
            {
                "depth": patch.depth,
                "position": patch.position,
                "stress": patch.stress,
                "von_mises": mises,
                "largest": {"von_mises": mises[maximum], "depth": patch.depth[maximum]},
            }
        )
    return {"patches": patches, "wavenumbers": stress.wavenumbers, "seconds": stress.seconds}


def overall(sides: Mapping[str, Mapping[str, Any]]) -> str:
    """Status of all sides: the first failure, else "converged", or "separated" without contact."""
    for side, report in sides.items():
        if report["status"].startswith("failed"):
            return f"failed: {side}: {report['status'].removeprefix('failed').lstrip(': ')}"
    return "converged" if any(report["status"] == "converged" for report in sides.values()) else "separated"


def json_text(report: Mapping[str, Any]) -> str:
    """The report as one line of JSON; NaN and infinity become null."""
    return json.dumps(_plain(report), allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def table(report: Mapping[str, Any]) -> RenderableType:
    """The report as a table with one column per side."""
    from rich.table import Table
    from rich.text import Text

    sides = [name for name in ("left", "right", "contact") if name in report]
    view = Table(title=f"{_heading(report)}: {report['status']}", title_justify="left")
    view.add_column("")
    for name in sides:
        view.add_column(name, justify="right")
    for label, text in _ROWS:
        view.add_row(Text(label), *(text(report[name]) if "force" in report[name] else "-" for name in sides))
    if any("error_estimate" in report[name] for name in sides):
        view.add_section()
        for label, key, scale in _ERROR_ROWS:
            estimates = [report[name].get("error_estimate") for name in sides]
            view.add_row(
                Text(f"error estimate: {label}"), *("-" if e is None else _error(scale * e[key]) for e in estimates)
            )
    for index in range(max((len(report[name].get("patches", ())) for name in sides), default=0)):
        view.add_section()
        for label, text in (*_PATCH_ROWS, *(_FRICTION_ROWS if report["friction"] else ())):
            patches = [report[name].get("patches", []) for name in sides]
            view.add_row(
                Text(f"patch {index + 1}: {label}"), *(text(p[index]) if index < len(p) else "" for p in patches)
            )
        for body in dict.fromkeys(body for name in sides for body in report[name].get("stress", ())):
            below = [report[name].get("stress", {}).get(body, {"patches": []})["patches"] for name in sides]
            label = f"patch {index + 1}: largest von Mises stress, {body} [MPa], at depth [mm]"
            view.add_row(Text(label), *(_largest(p[index]) if index < len(p) else "" for p in below))
    return view


def _heading(report: Mapping[str, Any]) -> str:
    parts = [f"{report['model']} model", *(f"laws {report[key]}" for key in ("laws",) if key in report)]
    parts += [f"{report[key]} {key}" for key in ("bodies", "points", "normal", "tangential") if key in report]
    return ", ".join(parts)


def _error(value: float) -> str:
    return "unknown" if math.isnan(value) else f"{value:.2g}"


def _largest(patch: Mapping[str, Any]) -> str:
    maximum = patch["largest"]
    return f"{1e-6 * maximum['von_mises']:.1f}  {1e3 * maximum['depth']:.3f}"


def _numbers(values: Any, scale: float, digits: int) -> str:
    return "  ".join(f"{scale * value:.{digits}f}" for value in values)


_ROWS = (
    ("status", lambda s: s["status"]),
    ("force x, y, z [kN]", lambda s: _numbers(s["force"], 1e-3, 3)),
    ("moment x, y, z [N m]", lambda s: _numbers(s["moment"], 1.0, 2)),
    ("normal force [kN]", lambda s: f"{1e-3 * s['normal_force']:.3f}"),
    ("tangential force longitudinal, lateral [kN]", lambda s: _numbers(s["tangential_force"], 1e-3, 3)),
    ("approach [µm]", lambda s: f"{1e6 * s['approach']:.2f}"),
    ("z [mm]", lambda s: f"{1e3 * s['z']:.4f}"),
    ("roll [mrad]", lambda s: f"{1e3 * s['roll']:.4f}"),
    (
        "contact points",
        lambda s: f"{s['statistics']['points']}" + ("" if s["statistics"]["settled"] else ", edges not converged"),
    ),
    ("contact solves", lambda s: str(s["statistics"]["contact_solves"])),
    ("Newton, linear iterations (last solve)", lambda s: f"{s['statistics']['newton']}, {s['statistics']['linear']}"),
    ("computing time [s]", lambda s: f"{s['statistics']['seconds']['all_solves']:.2f}"),
)
_ERROR_ROWS = (
    ("force [kN]", "force", 1e-3),
    ("moment [N m]", "moment", 1.0),
    ("peak pressure [MPa]", "max_pressure", 1e-6),
    ("area [mm²]", "area", 1e6),
)
_PATCH_ROWS = (
    ("normal force [kN]", lambda p: f"{1e-3 * p['normal_force']:.3f}"),
    ("area [mm²]", lambda p: f"{1e6 * p['area']:.2f}"),
    ("peak pressure [MPa]", lambda p: f"{1e-6 * p['max_pressure']:.1f}"),
    ("semi-axes longitudinal, lateral [mm]", lambda p: _numbers(p["semi_axes"], 1e3, 3)),
    ("contact angle [mrad]", lambda p: f"{1e3 * p['contact_angle']:.2f}"),
    ("position on wheel, on rail (arc length) [mm]", lambda p: _numbers((p["wheel_s"], p["rail_s"]), 1e3, 3)),
    ("stick area [mm²]", lambda p: f"{1e6 * p['stick_area']:.2f}"),
)
_FRICTION_ROWS = (
    ("creepage longitudinal, lateral [1e-3]", lambda p: _numbers(p["creepage"][:2], 1e3, 4)),
    ("spin creepage [1/m]", lambda p: f"{p['creepage'][2]:.4f}"),
    ("frictional power [W]", lambda p: f"{p['frictional_power']:.2f}"),
)
