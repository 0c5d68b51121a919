"""Quantities of results, each once: patches, wheels, runs, contact solutions."""

from __future__ import annotations

from typing import Any

from wheelrail.contact.results.packed_patches import COLUMNS
from wheelrail.scenes.quantity import Quantity, Schema
from wheelrail.scenes.schema.profiles import SIDES

AXES = ("longitudinal", "lateral", "vertical")
TURNS = ("roll", "spin", "yaw")
EDGES = ("low", "high")
TIME, BY_BODY, BY_ELEMENT = ("time",), ("time", "body"), ("time", "element", "axis")
BY_WHEEL, BY_WHEELSET = ("time", "wheelset", "side"), ("time", "wheelset")
BY_SIDE, BY_POINT, BY_PATCH, STRESSED = ("side",), ("point",), ("side", "patch"), ("side", "body", "patch", "depth")
# rad, of the surfaces across half a patch: the gap of two arcs of nearly the same radius R is 1 + 3/4 (y / R)^2 times
# that of their parabolas, here by 7 %, and pressures turn as much from the common normal of half-spaces.
WIDEST = 0.3
LARGEST_OVERLAP = 0.1  # of the approach: patches of virtual penetration differ by as much from elastic ones
FIELD_SIDE = "positive to the field side"
# Variables of the fields of a patch that are vectors; others have one of their own name.
COMPONENTS_OF = {
    "tangential_force": ("patch_longitudinal_force", "patch_lateral_force"),
    "semi_axes": ("patch_semi_axis_x", "patch_semi_axis_y"),
    "creepage": ("patch_longitudinal_creepage", "patch_lateral_creepage", "patch_spin"),
}
PATCH_FIELDS: dict[str, str | tuple[str, ...]] = {
    name: COMPONENTS_OF.get(name, name if name.startswith(("wheel_", "rail_")) else f"patch_{name}") for name in COLUMNS
}


# Label, unit and digits for readers, symbol and positive direction.
READERS: dict[str, tuple[Any, ...]] = {
    "patch_area": ("area", "mm²", 2),
    "patch_max_pressure": ("peak pressure", "MPa", 1),
    "patch_normal_force": ("normal force", "kN", 3),
    "patch_longitudinal_force": ("tangential force longitudinal, lateral", "kN", 3),
    "patch_semi_axis_x": ("semi-axes longitudinal, lateral", "mm", 3),
    "patch_contact_angle": ("contact angle", "mrad", 2),
    "patch_stick_area": ("stick area", "mm²", 2),
    "patch_longitudinal_creepage": ("creepage longitudinal, lateral", "1e-3", 4),
    "patch_spin": ("spin creepage", "1/m", 4),
    "patch_frictional_power": ("frictional power", "W", 2),
    "wheel_s": ("position on wheel, on rail (arc length)", "mm", 3),
    "wheel_y": ("wheel y", "mm", 2),
    "wheel_band": ("from the rolling circle", "mm", None, "", FIELD_SIDE),
    "rail_band": ("from the top of the rail", "mm", None, "", FIELD_SIDE),
    "longitudinal_force": ("longitudinal force", "kN", 2, "X", "positive forward"),
    "lateral_force": ("lateral force", "kN", 2, "Y", "positive to the left"),
    "vertical_force": ("vertical force", "kN", 2, "Q", "positive upwards"),
    "roll_moment": ("moment x, y, z", "N m", 2),
    "approach": ("approach", "µm", 2),
    "patches": ("simultaneous patches", "1", 0),
    **{f"body_{name}": (name, "mm", 3, "", "positive to the left" if name == "y" else "") for name in "xyz"},
    **{f"body_{name}": (name, "mrad", 3, "", "") for name in ("roll", "pitch")},
    "body_yaw": ("yaw", "mrad", 3, "", "positive to the left"),
    "wheel_spin": ("spin", "rad/s", 3, "", "positive forward"),
    "yaw_reaction": ("yaw reaction", "kN m", 2),
    "t_gamma": ("T-gamma", "N", 1),
    "patch_utilisation": ("utilisation T / N of a patch", "1"),
    "patch_load_factor": ("load factor p₀ / k of a patch", "1"),
    "patch_surface_fatigue_index": ("surface fatigue index (above 0: ratcheting)", "1"),
    "element_deflection": ("deflection", "mm", 2),
    "element_force": ("force", "kN", 2),
    "check_rail_force": ("check rail: normal force", "kN", 2),
    "check_rail_power": ("check rail: frictional power", "kW", 2),
    "guiding_force": ("guiding force", "kN", 2, "Y", "positive outwards"),
    "derailment_quotient": ("derailment quotient", "1", 3, "Y/Q", ""),
    "track_shifting_force": ("sum of Y", "kN", 2, "", "positive to the right"),
    "wheel_unloading": ("unloading", "%", 1),
    "force_error": ("error estimate: force", "kN"),
    "moment_error": ("error estimate: moment", "N m"),
    "max_pressure_error": ("error estimate: peak pressure", "MPa"),
    "area_error": ("error estimate: area", "mm²"),
    "z": ("z", "mm", 4),
    "roll": ("roll", "mrad", 4),
    "contact_seconds": ("computing time", "s", 2),
    "depth": ("depth", "mm", 3),
    "von_mises": ("largest von Mises stress", "MPa", 1),
}


def _shown(quantities: Schema) -> dict[str, Quantity]:
    """Quantities with their display attributes, such as label, symbol and digits."""
    names = ("label", "shown", "digits", "symbol", "sign")
    return {
        name: own._replace(**dict(zip(names, READERS[name], strict=False))) if name in READERS else own
        for name, own in quantities.items()
    }


_PATCH = {
    "patch_area": ("m2", "area of the patch"),
    "patch_max_pressure": ("Pa", "peak pressure of the patch"),
    "patch_normal_force": ("N", "normal force of the patch"),
    "patch_longitudinal_force": ("N", "tangential force on the wheel, positive forward"),
    "patch_lateral_force": ("N", "tangential force on the wheel in the contact plane, positive to the left"),
    "patch_semi_axis_x": ("m", "longitudinal semi-axis of the ellipse with equal second moments"),
    "patch_semi_axis_y": ("m", "lateral semi-axis of the same ellipse"),
    "patch_contact_angle": ("rad", "contact angle, rotation of the contact plane about the track direction"),
    "patch_stick_area": ("m2", "stick area"),
    "patch_longitudinal_creepage": (
        "1",
        "longitudinal creepage of the wheel at the resultant of the patch, positive forward",
    ),
    "patch_lateral_creepage": ("1", "lateral creepage of the wheel in the contact plane, positive to the left"),
    "patch_spin": ("rad/m", "spin creepage of the wheel about the upward normal of the patch"),
    "patch_frictional_power": ("W", "frictional power"),
    "patch_strips": (
        "1",
        "strips, or points of a grid, across the patch, 0 for models without; with less than 5 it is rough",
    ),
    "patch_x": ("m", "position of the resultant along the track"),
    "wheel_s": ("m", f"arc length on the wheel profile from the rolling circle, {FIELD_SIDE}"),
    "rail_s": ("m", f"arc length on the rail profile from the top of the inclined rail, {FIELD_SIDE}"),
    "wheel_y": ("m", f"lateral position on the wheel from the rolling circle, {FIELD_SIDE}"),
    "rail_y": ("m", f"lateral position on the rail from the top of the inclined rail, {FIELD_SIDE}"),
}
PATCH = _shown({name: Quantity((), unit, text) for name, (unit, text) in _PATCH.items()})
BANDS = _shown(
    {
        f"{body}_band": Quantity(("edge",), "m", f"lateral extent of the patch on the {where}, {FIELD_SIDE}")
        for body, where in (("wheel", "wheel from the rolling circle"), ("rail", "inclined rail from its top"))
    }
)


def wheel_quantities(by_wheel: tuple[str, ...]) -> dict[str, Quantity]:
    """Contact forces on the wheels and their patches; by_wheel: dimensions of a value of each wheel."""
    by_patch, about = (*by_wheel, "patch"), "moment of the contact force about the centre of the wheelset"
    return {
        **{f"{axis}_force": Quantity(by_wheel, "N", f"{axis} contact force on the wheel") for axis in AXES},
        **{f"{turn}_moment": Quantity(by_wheel, "N m", f"{turn} {about}") for turn in TURNS},
        "approach": Quantity(by_wheel, "m", "largest penetration of the undeformed bodies; negative is a gap"),
        "patches": Quantity(by_wheel, "1", "number of contact patches"),
        **{name: own._replace(dims=(*by_patch, *own.dims)) for name, own in {**PATCH, **BANDS}.items()},
    }


COORDINATE_TEXTS = {
    "x": "displacement forward of the place in the reference motion, with distance and speed",
    "y": "lateral displacement from the centre line of the track at the body's own centre, positive to the left; in a "
    "curve that of a long body contains the rise of its chord",
    "z": "height above the nominal position",
    "roll": "roll about the track direction",
    "pitch": "pitch; of a wheelset in excess of nominal rolling",
    "yaw": "yaw about the track normal, positive to the left",
}
IRREGULARITIES = {
    "alignment": "lateral irregularity of the track, positive to the left",
    "level": "vertical irregularity of the track, positive upwards",
    "cross_level": "irregularity of the height of the right rail above the left",
    "gauge": "irregularity of the gauge, positive for widening",
}
MOTION: Schema = {
    f"body_{name}{rate}": Quantity(BY_BODY, unit + per, f"rate of {text}" if rate else text)
    for (name, text), unit in zip(COORDINATE_TEXTS.items(), 3 * ("m",) + 3 * ("rad",), strict=True)
    for rate, per in (("", ""), ("_rate", "/s"))
}
TRACK: Schema = {
    "speed": Quantity(TIME, "m/s", "speed along the track"),
    "curvature": Quantity(TIME, "1/m", "curvature of the track, positive to the left"),
    "lift": Quantity(TIME, "m", "height of the right rail above the left"),
}
# Names and units of the components of motions.
COMPONENTS: dict[str, tuple[tuple[str, str], ...]] = {
    "hub_component": (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("pitch", "rad"), ("yaw", "rad")),
    "rail_component": (("y", "m"), ("z", "m"), ("roll", "rad")),
    "sleeper_component": (("y", "m"), ("z", "m")),
}
HUB, RAIL = "m and rad, x, y, z, then about x, y, z", "m and rad, y, z, then roll about the foot"
_BY_PATCH = (*BY_WHEEL, "patch")
RUN = _shown(
    {
        "time": Quantity(TIME, "s", "time"),
        "distance": Quantity(TIME, "m", "distance along the track"),
        "side": Quantity(BY_SIDE),
        "edge": Quantity(("edge",)),
        **TRACK,
        **{f"irregularity_{name}": Quantity(TIME, "m", text, needed=False) for name, text in IRREGULARITIES.items()},
        "contact_solves": Quantity(BY_SIDE, "1", "contact problems solved"),
        "failed_solves": Quantity(BY_SIDE, "1", "contact problems that failed and were repeated"),
        "newton_iterations": Quantity(BY_SIDE, "1", "total Newton iterations"),
        "linear_iterations": Quantity(BY_SIDE, "1", "total linear iterations"),
        "contact_seconds": Quantity(BY_SIDE, "s", "time for all contact solves, of all threads"),
        "body": Quantity(("body",)),
        "nominal_x": Quantity(("body",), "m", "place along the vehicle, forward"),
        "wheelset": Quantity(("wheelset",)),
        "contact": Quantity(("wheelset",), "", "name of its contact in the scene, empty: that of the scene", False),
        "element": Quantity(("element",)),
        "axis": Quantity(("axis",)),
        **MOTION,
        "wheel_spin": Quantity(BY_WHEEL, "rad/s", "spin about the axle, of wheels that turn by themselves", False),
        "series_deflection": Quantity(
            ("time", "series"),
            "m",
            "deflection of the series springs of the Maxwell elements, in the order of elements and axes",
            False,
        ),
        "hub_motion": Quantity(
            (*BY_WHEEL, "hub_component"), HUB, "motion of the hub relative to the line through the journals", False
        ),
        "rail_motion": Quantity((*BY_WHEEL, "rail_component"), RAIL, "motion of the rail on its pads", False),
        "sleeper_motion": Quantity(
            (*BY_WHEEL, "sleeper_component"),
            "m",
            "motion of the sleepers under the wheel, across and normal to the foot of the rail",
            False,
        ),
        "yaw_reaction": Quantity(BY_WHEELSET, "N m", "reaction moment of the held yaw of the wheelset", False),
        **wheel_quantities(BY_WHEEL),
        "in_contact": Quantity(BY_WHEEL, "1", "whether wheel and rail are in contact"),
        "frictional_power": Quantity(BY_WHEEL, "W", "frictional power, all patches of a wheel", False),
        "t_gamma": Quantity(BY_WHEEL, "N", "T-gamma: frictional energy per metre of track", False),
        "patch_utilisation": Quantity(_BY_PATCH, "1", "tangential over normal force of the patch", False),
        "patch_load_factor": Quantity(_BY_PATCH, "1", "peak pressure over the shear yield stress", False),
        "patch_surface_fatigue_index": Quantity(
            _BY_PATCH, "1", "surface fatigue index, utilisation minus 1 / load factor; above 0: ratcheting", False
        ),
        "element_deflection": Quantity(
            BY_ELEMENT,
            "m",
            "displacement of the upper point of the element relative to the lower one, in the element's axes",
            True,
        ),
        "element_force": Quantity(
            BY_ELEMENT, "N", "force of the element on the upper body, static load included, in the element's axes", True
        ),
        "applied_torque": Quantity(
            BY_WHEELSET, "N m", "torque of motors and brakes on the wheelset about its axle, positive forwards", False
        ),
        "applied_force": Quantity(
            ("time", "body", "axis"),
            "N",
            "sum of the applied forces on the body, along the axes of the track section there",
            False,
        ),
        "check_rail_force": Quantity(BY_WHEEL, "N", "normal force of the check rail on the flange's back", False),
        "check_rail_power": Quantity(BY_WHEEL, "W", "frictional power of flange back and check rail", False),
        "guiding_force": Quantity(BY_WHEEL, "N", "guiding force Y: lateral force on the rail, positive outwards", True),
        "derailment_quotient": Quantity(BY_WHEEL, "1", "derailment quotient Y/Q; NaN without load"),
        "track_shifting_force": Quantity(
            BY_WHEELSET, "N", "sum of Y: lateral force of both wheels on the track, to the right", True
        ),
        "axle_load": Quantity(BY_WHEELSET, "N", "sum of Q"),
        "wheel_unloading": Quantity(BY_WHEEL, "1", "1 - Q / mean static wheel load"),
        "mechanical_energy": Quantity(TIME, "J", "kinetic and elastic energy, spin relative to nominal rolling", False),
        "power": Quantity(("time", "cause"), "W", "power by cause of change of the mechanical energy", False),
        "work": Quantity(("time", "cause"), "J", "work by the same cause since the first sample", False),
        "cause": Quantity(("cause",), "", "", False),
    }
)
ERRORS = {
    name: _shown({f"{name}_error": Quantity(BY_SIDE, unit, f"estimated error of the {text}", False)})[f"{name}_error"]
    for name, unit, text in (
        ("force", "N", "force, magnitude"),
        ("moment", "N m", "moment, magnitude"),
        ("max_pressure", "Pa", "peak pressure"),
        ("area", "m2", "contact area"),
    )
}
CONTACT = _shown(
    {
        "side": Quantity(BY_SIDE),
        "status": Quantity(BY_SIDE, "", "status of the solve"),
        **wheel_quantities(BY_SIDE),
        "patch_force": Quantity((*BY_PATCH, "axis"), "N", "force of the patch on the wheel"),
        **{f"{name}_error": own for name, own in ERRORS.items()},
        **{
            f"{name}_count": Quantity(BY_SIDE, "1", f"{text} of the last solve")
            for name, text in (
                ("newton", "Newton iterations"),
                ("linear", "linear iterations"),
                ("points", "contact points"),
            )
        },
        "residual": Quantity(BY_SIDE, "1", "relative residual of the last solve"),
        "phase": Quantity(("phase",), "", "", False),
        "phase_seconds": Quantity(("side", "phase"), "s", "time for a phase of the last solve", False),
        "share": Quantity(
            BY_POINT, "1", "share of the strips of the point in the result, between two widths of strips", False
        ),
        "point_side": Quantity(BY_POINT, "", "side of the point"),
        "point_patch": Quantity(BY_POINT, "1", "patch of the point, -1 for none"),
        **{
            f"point_{name}": Quantity(BY_POINT, "m", f"{PATCH[name].text}, of the undeformed body at the point", False)
            for name in ("wheel_s", "rail_s")
        },
        "position": Quantity(
            ("point", "axis"), "m", "position in the frame of the rail of the side: forward, left, up"
        ),
        "axes": Quantity(
            ("point", "direction", "axis"), "1", "longitudinal, lateral and outward normal axis of the wheel surface"
        ),
        "area": Quantity(BY_POINT, "m2", "area of the cell of the point, times its share"),
        "step": Quantity(BY_POINT, "m", "length of the cell of the point in rolling direction"),
        "penetration": Quantity(BY_POINT, "m", "penetration of the undeformed bodies"),
        "pressure": Quantity(BY_POINT, "Pa", "contact pressure"),
        "traction": Quantity(("point", "tangent"), "Pa", "tangential traction on the wheel"),
        "slip": Quantity(
            ("point", "tangent"), "1", "slip velocity of the wheel against the rail over the rolling speed"
        ),
        "displacement": Quantity(("point", "direction"), "m", "elastic displacement, wheel minus rail"),
        "sticks": Quantity(BY_POINT, "1", "whether the surfaces stick"),
    }
)
# Further variables of the solution of a scene: poses, cost, shapes, elastic axle and rails, stress below the patches.
SOLUTION = _shown(
    {
        "z": Quantity(BY_SIDE, "m", "height above the nominal one", False),
        "roll": Quantity(BY_SIDE, "rad", "roll of the wheelset", False),
        "wheel_origin": Quantity(
            ("side", "axis"), "m", "centre of the wheel in the plane of the rolling circle", False
        ),
        "wheel_rotation": Quantity(("side", "axis", "wheel_axis"), "1", "axes of the wheel as columns", False),
        "contact_solves": Quantity(BY_SIDE, "1", "contact problems solved", False),
        "contact_seconds": Quantity(BY_SIDE, "s", "time for all contact solves", False),
        **{
            f"patch_gap_curvature_{axis}": Quantity(
                BY_PATCH, "1/m", f"half the relative curvature of the rigid bodies at the patch centre, {where}", False
            )
            for axis, where in (("x", "longitudinal"), ("y", "lateral"))
        },
        "patch_turn": Quantity(
            BY_PATCH,
            "rad",
            f"turn of the surfaces across half the patch; half-spaces stand for them up to {WIDEST:g}",
            False,
        ),
        "unsolved_overlap": Quantity(
            BY_SIDE,
            "m",
            "overlap of the undeformed bodies beyond their lowering outside the patches; up to "
            f"{LARGEST_OVERLAP:g} of the approach patches of virtual penetration have",
            False,
        ),
        "unsolved_overlap_y": Quantity(BY_SIDE, "m", "its lateral position on the profile of the wheel", False),
        "hub_motion": Quantity(("side", "hub_component"), HUB, "motion of the hub against the wheelset", False),
        "rail_motion": Quantity(("side", "rail_component"), RAIL, "motion of the rail on its pads", False),
        "axle_y": Quantity(("axle_place",), "m", "distance from the middle of the axle", False),
        "axle_stress": Quantity(
            ("side", "axle_place"), "Pa", "bending stress at the bottom of the axle, on this side", False
        ),
        "body": Quantity(("body",), "", "", False),
        "depth": Quantity(("depth",), "m", "depth below the surface", False),
        "von_mises": Quantity(STRESSED, "Pa", "von Mises stress below the patch", False),
        "stress": Quantity((*STRESSED, "axis", "other_axis"), "Pa", "stress below the patch", False),
        "stress_position": Quantity((*STRESSED, "axis"), "m", "position of the stress", False),
        "stress_wavenumbers": Quantity(("side", "body"), "1", "number of wavenumbers of the stress", False),
        "stress_seconds": Quantity(("side", "body"), "s", "computing time of the stress", False),
    }
)
# Motion of a vehicle on straight track after a kick, and its modes.
CYCLE = {
    "speed": Quantity((), "m/s", "speed", label="speed"),
    "amplitude": Quantity(BY_WHEELSET[1:], "m", "half the difference of extreme displacements", True, "y", "mm", 3),
    "growth": Quantity((), "1/s", "growth of small motions", label="growth of small motions", digits=3),
    "frequency": Quantity((), "Hz", "frequency", label="frequency", digits=3),
    "track_shifting_force": RUN["track_shifting_force"]._replace(sign=""),
    "frictional_power": RUN["frictional_power"]._replace(label="frictional power", shown="kW", digits=3),
    "duration": Quantity((), "s", "duration", label="duration", digits=1),
}
# Assessed quantities of running safety, the percentile of a filtered history each.
SAFETY = {
    "track_shifting": Quantity((), "N", label="sum of Y, 2 m mean, to the right", shown="kN", digits=2),
    **{f"quotient_{side}": Quantity((), "1", label=f"Y/Q, 2 m mean, {side}", digits=3) for side in SIDES},
    **{f"load_{side}": Quantity((), "N", label=f"Q, {side}", shown="kN", digits=1) for side in SIDES},
    "instability": Quantity((), "N", label="rms of the sum of Y over 100 m", shown="kN", digits=2),
}
