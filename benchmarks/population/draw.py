"""Random situations of a wheelset on its track, each from one integer and printable as one line of Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.population.oracle import Position, RigidSide
from benchmarks.population.profiles import Shape, rail, wheel
from wheelrail.contact.kinematics.frames import SIDES, Side

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState

ODD = ("y", "roll", "yaw", "y_rate", "roll_rate", "yaw_rate")  # change sign in the mirror y = 0
HEADER = """import wheelrail as wr
from benchmarks.population.profiles import rail, wheel
"""
MESHED = (  # pairs whose compliance is computed once: wheel, rail, inclination, radius
    (wheel("S1002"), rail("60E1"), 0.025, 0.46),
    (wheel("S1002"), rail("60E1"), 0.05, 0.42),
    (wheel("S1002", hollow_field=1e-3), rail("60E1", corner=1e-3), 0.025, 0.46),
    (wheel("cone", slope=0.05), rail("arcs", crown=0.254), 0.025, 0.35),
)
SUFFIXES = {"wheel": (".prw", ".whl", ".wheel"), "rail": (".prr", ".ban", ".rail")}


@dataclass(frozen=True)
class Situation:
    """Arguments of `wheelrail.Wheelset` and of its `solve`; wheels and rails are shapes."""

    seed: int
    wheelset: dict[str, Any]
    solve: dict[str, Any]

    def __str__(self) -> str:
        return f"wr.Wheelset({_text(self.wheelset)}).solve({_text(self.solve)})"

    def on(self, side: Side) -> dict[str, Any]:
        """Arguments of one side."""
        return {**self.wheelset, **self.wheelset.get(side, {})}

    @property
    def sides(self) -> tuple[Side, ...]:
        return tuple(self.solve.get("sides", SIDES))

    @cached_property
    def rigid(self) -> dict[Side, RigidSide]:
        """Rigid wheel and rail of every side."""
        return {side: self._rigid(side) for side in SIDES}

    def _rigid(self, side: Side) -> RigidSide:
        own, nominal = self.on(side), self.wheelset["radius"]
        return RigidSide(
            wheel=own["wheel"],
            rail=own["rail"],
            inclination=own["laying_angle"],
            radius=own["radius"],
            nominal=nominal,
            wheel_y=0.5 * own["flange_back_distance"] + 0.07,
            gauge=own["gauge"],
            gauge_height=0.014,
        )

    def position(self, side: Side, z: float, roll: float) -> Position:
        """Position as that of a left-hand pair."""
        at = Position(self.solve["y"], z, roll, self.solve["yaw"])
        return at if side == "left" else at.mirrored()

    def given_position(self, side: Side) -> Position:
        """Position at the given height, or the nominal one, and the given roll, or none."""
        roll = self.solve.get("roll", 0.0)
        return self.position(side, self.solve.get("z", 0.0), 0.0 if roll == "solve" else roll)

    @property
    def state(self) -> WheelsetState:
        """Position and velocities; a height or roll that is solved for is zero."""
        from wheelrail.contact.kinematics.wheelset_state import WheelsetState

        given = {key: value for key, value in self.solve.items() if key in WheelsetState.coordinates}
        if given.get("roll") == "solve":
            del given["roll"]
        speed = self.solve["speed"]
        given.setdefault("pitch_rate", speed / self.wheelset["radius"])
        return WheelsetState(**given, speed=speed, frame_rate=(0.0, 0.0, speed * self.wheelset["curvature"]))

    def mirrored(self) -> Situation:
        """The mirror image in y = 0, with the other side's profiles."""
        solve: dict[str, Any] = dict(self.solve)
        solve |= {key: -value for key, value in solve.items() if key in ODD and value != "solve"}
        if "sides" in solve:
            solve["sides"] = tuple({"left": "right", "right": "left"}[side] for side in solve["sides"])
        wheelset = {key: value for key, value in self.wheelset.items() if key not in SIDES}
        for side, other in zip(SIDES, SIDES[::-1], strict=True):
            if side in self.wheelset:
                wheelset[other] = self.wheelset[side]
        wheelset["curvature"] = -wheelset["curvature"]
        return replace(self, wheelset=wheelset, solve=solve)

    def with_model(self, **changes: Any) -> Situation:
        """The same with another contact model on rigid axle and rails; None removes a key."""
        without = ("model", "normal", "tangential", *ELASTIC, "axle", "pads", "table")
        kept = {key: value for key, value in self.wheelset.items() if key not in without}
        solve = {key: value for key, value in self.solve.items() if key != "error_estimate"}
        return replace(self, wheelset={**kept, **changes}, solve=solve)


ELASTIC = ("bodies", "points", "strips", "cells", "surface_size", "laws")


def _text(arguments: dict[str, Any]) -> str:
    """Arguments as Python, shapes as profiles."""

    def plain(value: Any) -> str:
        if isinstance(value, Shape):
            return f"{value!r}.profile"
        if isinstance(value, dict):
            return f"{{{', '.join(f'{key!r}: {plain(item)}' for key, item in value.items())}}}"
        return repr(value)

    return ", ".join(f"{key}={plain(value)}" for key, value in arguments.items())


def with_profiles(value: Any) -> Any:
    """Arguments with profiles in place of shapes."""
    if isinstance(value, Shape):
        return value.profile
    return {key: with_profiles(item) for key, item in value.items()} if isinstance(value, dict) else value


def situation(seed: int, measured: Sequence[Path] = (), quick: bool = False) -> Situation:
    """Situation of a seed.

    Parameters:
        seed: of the random numbers.
        measured: files of measured profiles.
        quick: half-spaces and the standard contact only.
    """
    return _Draw(np.random.default_rng(seed), measured, quick).situation(seed)


class _Draw:
    """Draws of one situation."""

    def __init__(self, random: np.random.Generator, measured: Sequence[Path], quick: bool) -> None:
        self.random, self.measured, self.quick = random, measured, quick

    def chance(self, part: float) -> bool:
        return bool(self.random.random() < part)

    def uniform(self, low: float, high: float) -> float:
        return _short(self.random.uniform(low, high))

    def logarithmic(self, low: float, high: float) -> float:
        return _short(float(np.exp(self.random.uniform(np.log(low), np.log(high)))))

    def signed(self, low: float, high: float) -> float:
        return self.logarithmic(low, high) * (1 if self.chance(0.5) else -1)

    def choice(self, weighted: Mapping[Any, float]) -> Any:
        names, weights = list(weighted), np.array(list(weighted.values()))
        return names[int(self.random.choice(len(names), p=weights / weights.sum()))]

    def situation(self, seed: int) -> Situation:
        model = self.model()
        meshed = model.get("bodies") in ("waveguide", "solid")
        track, wheelset = self.track(), self.pair(meshed)
        arguments: dict[str, Any] = {**wheelset, **track, "friction": self.friction(), **model}
        if not meshed:
            arguments |= self.sides_apart(arguments)
        solve: dict[str, Any] = {"y": self.lateral(), "yaw": self.yaw()}
        if meshed or model.get("bodies") == "half-space":
            if self.chance(0.06):
                arguments["axle"] = True
            if self.chance(0.06):
                arguments["pads"] = True
            if model.get("points") != "grid" and self.chance(0.03):
                solve["error_estimate"] = True
        drawn = Situation(seed, arguments, solve)
        solve |= self.loading(drawn)
        solve |= self.motion(arguments["radius"])
        if arguments["wheel"] == wheel("S1002") and not meshed and "z" not in solve and self.chance(0.2):
            arguments["wheel"] = wheel("S1002", abraded=self.logarithmic(1e-5, 2e-3))
        return drawn

    def model(self) -> dict[str, Any]:
        """Contact model and resolution."""
        kinds = {
            "half-space": 50,
            "standard": 35,
            "waveguide": 10,
            "grid": 3,
            "solid": 0.4,
            "full": 0.1,
        }  # a minute each
        kind = self.choice({name: weight for name, weight in kinds.items() if not self.quick or weight > 20})
        if kind == "standard":
            normal = self.choice({None: 2, "kik-piotrowski": 1, "hertz": 2})
            tangential = self.choice({None: 2, "fastsim": 1, "polach": 2})
            own = {"normal": normal, "tangential": tangential}
            return {"model": "standard", **{key: value for key, value in own.items() if value}}
        if kind == "full":
            return {"model": "full", "bodies": "solid", "surface_size": 2e-3}
        if kind in ("grid", "solid"):
            laws = self.choice({"exact": 1, "paper": 1})
            bodies = "waveguide" if kind == "grid" else "solid"
            size = self.choice({1e-3: kind == "grid", 2e-3: 1})
            return {"bodies": bodies, "points": "grid", "surface_size": size, "laws": laws}
        how: dict[str, Any] = {"bodies": kind}
        if self.chance(0.65):
            how |= {"strips": int(self.random.integers(4, 15)), "cells": int(self.random.integers(6, 15))}
        return how

    def track(self) -> dict[str, Any]:
        gauge = self.choice({1.435: 8, 1.432: 1, 1.44: 1, 1.465: 1, 1.0: 1, 1.067: 1, 1.52: 1, 1.6: 1, 1.676: 1})
        back = _short(gauge - self.choice({0.075: 4, 0.072: 1, 0.077: 1, 0.082: 1}))
        curvature = _short(1.0 / self.signed(150.0, 5000.0)) if self.chance(0.25) else 0.0
        return {"gauge": gauge, "flange_back_distance": back, "curvature": curvature}

    def pair(self, meshed: bool) -> dict[str, Any]:
        """Profiles, inclination and radius."""
        if meshed:
            own = MESHED[int(self.random.integers(len(MESHED)))]
            return dict(zip(("wheel", "rail", "laying_angle", "radius"), own, strict=True))
        radius = self.choice({0.46: 3, self.uniform(0.25, 0.65): 7})
        return {"wheel": self.wheel(), "rail": self.rail(), "laying_angle": self.inclination(), "radius": radius}

    def wheel(self) -> Shape:
        files = [file for file in self.measured if file.suffix.lower() in SUFFIXES["wheel"]]
        if files and self.chance(0.4):
            return wheel(str(files[int(self.random.integers(len(files)))]))
        base = self.choice({"S1002": 7, "cone": 3, "cylinder": 0.7, "disc": 0.3})
        form: dict[str, float] = {}
        if base == "cone":
            form = {
                "slope": self.choice({0.025: 1, 0.05: 2, 0.1: 1}),
                "face": self.choice({1.047: 1, 1.22: 2, 1.309: 1}),
            }
        if base == "cylinder":
            base, form = "cone", {"slope": 0.0}
        if base == "disc":
            return wheel("disc", crown=self.choice({0.1: 1, 0.3: 1, 1.0: 1}))
        if self.chance(0.45):
            kinds = ("hollow", "hollow_field", "tread", "flange")
            worn = [kind for kind in kinds if self.chance(0.45)]
            form |= {kind: self.logarithmic(1e-4, 3e-3) for kind in worn}
        return wheel(base, **form)

    def rail(self) -> Shape:
        files = [file for file in self.measured if file.suffix.lower() in SUFFIXES["rail"]]
        if files and self.chance(0.4):
            return rail(str(files[int(self.random.integers(len(files)))]))
        base = self.choice({"60E1": 6, "arcs": 3, "groove": 0.8, "flat": 0.4})
        form: dict[str, float] = {}
        if base in ("arcs", "groove"):
            crown = self.choice({0.3: 2, 0.254: 1, 0.203: 1, 0.5: 1})
            form = {"crown": crown, "radius": self.choice({13e-3: 2, 10e-3: 1, 16e-3: 1})}
        if base == "groove":
            form |= {"depth": self.choice({47e-3: 3, 30e-3: 1, 27e-3: 1}), "width": self.choice({42e-3: 2, 58e-3: 1})}
        if base == "flat":
            return rail("flat", radius=self.choice({5e-3: 1, 10e-3: 1}))
        if self.chance(0.35):
            worn = [kind for kind in ("flattened", "corner", "side") if self.chance(0.45)]
            form |= {kind: self.logarithmic(1e-4, 2.5e-3) for kind in worn}
        return rail(base, **form)

    def inclination(self) -> float:
        angle = self.choice({0.025: 45, 0.05: 25, 0.0: 10, 0.1: 5, self.uniform(0.0, 0.1): 15})
        return float(angle)

    def friction(self) -> float:
        return float(self.choice({0.0: 1, 0.3: 3, self.uniform(0.0, 1.0): 5, self.logarithmic(1e-3, 0.1): 1}))

    def sides_apart(self, arguments: dict[str, Any]) -> dict[str, Any]:
        """What differs on one side."""
        own: dict[str, Any] = {}
        if self.chance(0.3):
            own["radius"] = _short(arguments["radius"] + self.signed(1e-5, 3e-3))
        if self.chance(0.12):
            own["wheel"] = self.wheel()
        if self.chance(0.12):
            own |= {"rail": self.rail(), "laying_angle": self.inclination()}
        if self.chance(0.05):
            own["friction"] = self.friction()
        return {self.choice({"left": 1, "right": 1}): own} if own else {}

    def lateral(self) -> float:
        spans = {8e-3: 75, 2e-2: 15, 9e-2: 10}
        return _short(self.uniform(-1.0, 1.0) * self.choice(spans)) if self.chance(0.9) else 0.0

    def yaw(self) -> float:
        return _short(self.uniform(-1.0, 1.0) * self.choice({1e-3: 1, 5e-3: 2, 3e-2: 1})) if self.chance(0.7) else 0.0

    def loading(self, drawn: Situation) -> dict[str, Any]:
        """Load, or height, roll and sides."""
        flexible = "axle" in drawn.wheelset or "pads" in drawn.wheelset
        load = self.uniform(2e4, 1.5e5) if self.chance(0.7) else self.logarithmic(1.0, 3e5)
        roll = _short(self.uniform(-1.0, 1.0) * self.choice({1e-3: 1, 1e-2: 1})) if self.chance(0.5) else 0.0
        kind = self.choice({"wheel": 0 if flexible else 4, "solve": 3, "axle": 2, "height": 2})
        if kind == "solve":
            return {"wheel_load": load, "roll": "solve"}
        if kind == "axle":
            return {"axle_load": _short(2.0 * load), "roll": roll}
        sides = {} if flexible else self.choice({None: 6, "left": 1, "right": 1})
        given: dict[str, Any] = {"roll": roll, **({"sides": (sides,)} if sides else {})}
        if kind == "wheel":
            return {"wheel_load": load, **given}
        drawn = replace(drawn, solve={**drawn.solve, **given})
        touching = max(drawn.rigid[side].first_contact(drawn.given_position(side)) for side in drawn.sides)
        if not np.isfinite(touching):
            touching = 0.0
        depth = self.logarithmic(1e-6, 4e-4) if self.chance(0.8) else -self.logarithmic(1e-6, 1e-2)
        return {"z": float(np.clip(np.round(touching - depth, 9), -0.1, 0.1)), **given}

    def motion(self, radius: float) -> dict[str, float]:
        """Speed and creepages."""
        speed = self.logarithmic(0.1, 120.0)
        rates: dict[str, float] = {"speed": speed}
        if self.chance(0.4):
            rates["pitch_rate"] = _short(speed / radius * (1.0 + self.signed(1e-5, 5e-2)))
        if self.chance(0.25):
            rates["y_rate"] = _short(speed * self.signed(1e-5, 1e-2))
        if self.chance(0.1):
            rates |= {"z_rate": _short(speed * self.signed(1e-5, 1e-3)), "yaw_rate": self.signed(1e-4, 0.1)}
        return rates


def _short(value: float) -> float:
    """Six digits."""
    return float(f"{value:.6g}")
