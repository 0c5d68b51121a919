"""Units and plausible ranges of the values of a wagon."""

from __future__ import annotations

from math import inf

from wheelrail.scenes.schema.quantities import Range

HEIGHT = Range(0.05, 5.0, "m above top of rail")
STIFFNESS = Range(1e3, 1e10, "N/m, or points [m, N]")
DAMPING = Range(0.0, 1e9, "N s/m, or points [m/s, N]")
INERTIA = Range(1.0, 1e9, "kg m2")
PLACE = Range(0.0, 5.0, "m")
SERIES = Range(1e3, inf, "N/m, in series with the damper; inf is none")

WAGON = {
    "mass": Range(50.0, 1e6, "kg"),
    "roll_inertia": INERTIA,
    "pitch_inertia": INERTIA,
    "yaw_inertia": INERTIA,
    "height": HEIGHT,
    "lateral_stiffness": STIFFNESS,
    "vertical_stiffness": STIFFNESS,
    "lateral_damping": DAMPING,
    "vertical_damping": DAMPING,
    "bending_stiffness": Range(0.0, 1e9, "N m/rad"),
    "spring_y": PLACE,
    "spring_height": HEIGHT,
    "damper_y": PLACE,
    "damper_height": HEIGHT,
    "turn": Range(0.0, 1.0, "fraction of the upper body's roll that rotates the axes of springs and dampers"),
    "lateral_series_stiffness": SERIES,
    "vertical_series_stiffness": SERIES,
    "roll_bar": Range(0.0, 1e10, "N m/rad, per bogie"),
    "bumpstop": Range(0.0, inf, "[m, N], the same in both directions"),
    "bumpstop_height": HEIGHT,
    "gravity": Range(0.0, 30.0, "m/s2"),
}
REACH = {False: 1.0, True: 100.0}  # largest abscissa of a force law: m of a spring or stop, m/s of a damper
