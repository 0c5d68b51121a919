"""Track, wagon and vehicle of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from wheelrail.vehicle.loads.applied_loads import AppliedLoads
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon


def run_track(scene: RunScene, vehicle: Vehicle) -> Track:
    """Track of a scene whose irregularities begin at the front wheelset, as runs start in equilibrium.

    Raises SceneError where they are too short.
    """
    try:
        return scene.track.track(max(vehicle.bodies[name].x for name in vehicle.wheelsets))
    except ValueError as error:
        raise SceneError(f"track.irregularities: {error}") from error


def wagon(scene: RunScene) -> Wagon:
    """Wagon of the scene, with the wheel radius of the scene."""
    return scene.vehicle.on(scene.wheelset.radius)


def applied_loads(scene: RunScene, vehicle: Vehicle) -> AppliedLoads:
    """Torques and forces of a scene on a vehicle.

    Parameters:
        scene: of a run.
        vehicle: on which they act.

    Raises SceneError for wheelsets and bodies that the vehicle does not have.
    """
    from wheelrail.vehicle.loads.applied_loads import AppliedLoads, BodyForce, WheelsetTorque

    torques, forces = list[WheelsetTorque](), list[BodyForce]()
    for number, part in enumerate(scene.torque or ()):
        table, brake = part.table(part.torque), part.kind == "brake"
        names = part.wheelsets or vehicle.wheelsets
        own = tuple(WheelsetTorque(name, table, part.reaction, brake) for name in names)
        _check(f"torque[{number}]", AppliedLoads(torques=own), vehicle)
        torques.extend(own)
    for number, load in enumerate(scene.force or ()):
        values = {key: load.table(getattr(load, key)) for key in ("longitudinal", "lateral", "vertical")}
        force = BodyForce(load.body, load.point, **values)
        _check(f"force[{number}]", AppliedLoads(forces=(force,)), vehicle)
        forces.append(force)
    return AppliedLoads(tuple(torques), tuple(forces))


def _check(key: str, loads: AppliedLoads, vehicle: Vehicle) -> None:
    """Raises SceneError for torques and forces, of one table of a scene, that do not fit a vehicle."""
    from wheelrail.vehicle.multibody.applied_forces import AppliedForces
    from wheelrail.vehicle.multibody.coordinates import Coordinates
    from wheelrail.vehicle.multibody.elements import InvalidVehicle

    try:
        AppliedForces(Coordinates(vehicle), loads)
    except InvalidVehicle as error:
        _, number, name = error.key.split(".")
        part = (*loads.torques, *loads.forces)[int(number)]
        value = getattr(part, name)
        given = "" if value is None else f' = "{value}"'
        raise SceneError(f"{key}.{'wheelsets' if name == 'wheelset' else name}{given}: {error.allowed}") from None


def vehicle_on(scene: RunScene, file: Path | None = None) -> Vehicle:
    """Vehicle on the wheels of a scene.

    Parameters:
        scene: of the run.
        file: vehicle file; None: the plane wagon of the scene.

    Raises SceneError, also for wheels of another radius than those of the scene, and for wheelsets that are not of the
    vehicle.
    """
    if file is None:
        from wheelrail.vehicle.multibody.plane_wagon import plane_vehicle

        return plane_vehicle(wagon(scene))
    vehicle = load_vehicle(file)
    check_fit(scene, vehicle, file)
    return vehicle


def check_fit(scene: RunScene, vehicle: Vehicle, file: Path) -> None:
    """Raise SceneError for a vehicle that does not fit a scene; file: of the vehicle."""
    tables: dict[str, tuple[str, ...]] = {f"wheelsets.{name}": (name,) for name in scene.wheelsets or {}}
    tables |= {f"contacts.{name}.wheelsets": own.wheelsets for name, own in (scene.contacts or {}).items()}
    for key, names in tables.items():
        if not set(names) <= set(vehicle.wheelsets):
            raise SceneError(f"{key}: must be one of {', '.join(vehicle.wheelsets)}, the wheelsets of {file}")
    for name in vehicle.independent:
        if scene.on_wheelset(name).wheelset.axle is not None:
            raise SceneError(f"{file}: bodies.{name}.independent = true: must be false with an elastic wheelset.axle")
    if vehicle.radius != scene.wheelset.radius:
        text = f"must be {scene.wheelset.radius:g} m, wheelset.radius of the scene"
        raise SceneError(f"{file}: bodies.{vehicle.wheelsets[0]}.height = {vehicle.radius:g}: {text}")


def car_bodies(vehicle: Vehicle) -> dict[str, list[str]]:
    """Bodies that move freely and carry no other, each with its carriers; couplers carry nothing."""
    below = dict[str, list[str]]()
    for own in vehicle.elements.values():
        if own.carries:
            below.setdefault(own.upper, []).append(own.lower)
    carried = {lower for lowers in below.values() for lower in lowers}
    return {name: below[name] for name, b in vehicle.bodies.items() if name in below.keys() - carried and not b.held}


def floor_points(vehicle: Vehicle, floor: float) -> dict[str, tuple[str, tuple[float, float, float]]]:
    """Body and place m of points on the floor of car bodies, by name: above the first and the last body that carries
    one, and in the middle between.
    """
    found = dict[str, tuple[str, tuple[float, float, float]]]()
    for name, below in car_bodies(vehicle).items():
        ends = sorted({vehicle.bodies[lower].x for lower in below})
        middle = 0.5 * (ends[0] + ends[-1])
        places = {"front": ends[-1], "middle": middle, "rear": ends[0]} if len(ends) > 1 else {"middle": middle}
        found |= {f"{name} {where}": (name, (x, 0.0, floor)) for where, x in places.items()}
    return found
