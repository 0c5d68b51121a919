"""Contact model and motion of a Hertz scene. Heavy packages are imported only when a model is built."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.builders.laws import laws, material, standard_contact
from wheelrail.scenes.schema.scene import HertzScene

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import RigidMotion
    from wheelrail.contact.models.wheelset import ContactModel


def hertz_model(scene: HertzScene) -> ContactModel:
    """Contact model of the pair of bodies."""
    radii = scene.upper.radii, scene.lower.radii
    if scene.model == "standard":
        from wheelrail.contact.geometry.rigid_surfaces import RigidQuadrics

        return standard_contact(scene, RigidQuadrics(*radii), scene.upper, scene.lower)
    from wheelrail.contact.models.builders import hertz_pair
    from wheelrail.contact.models.quadric_bodies import Blocks

    materials, how = (material(scene.upper), material(scene.lower)), scene.discretisation
    sizes = {key: getattr(scene, key) for key in ("half_width", "half_strip", "growth")}
    blocks = Blocks(**{key: value for key, value in sizes.items() if value is not None})
    loads = {"load": scene.load, "approach": scene.approach}
    model: Any = hertz_pair(radii, materials, laws(scene), how, **loads, blocks=blocks)
    return model if scene.shift is None else replace(model, tangential="shift")  # type: ignore[no-any-return]


def hertz_motion(scene: HertzScene) -> RigidMotion:
    """Rigid motion of both bodies: material flows backwards through the contact at the rolling speed.

    Half of the creepage is applied to either body, so that the mean velocity is the speed. Zero for a frictionless
    scene without motion; for a tangential displacement ("shift") twists are displacements of the bodies.
    """
    import numpy as np

    from wheelrail.contact.kinematics.frames import RigidMotion, Twist

    if scene.shift is not None:
        displacement, zero = 0.5 * np.array([*scene.shift, 0.0]), np.zeros(3)
        return RigidMotion(Twist(displacement, zero, zero), Twist(-displacement, zero, zero))
    speed, (xi, eta, phi) = scene.speed or 0.0, scene.creepage or (0.0, 0.0, 0.0)
    flow, slip, origin = np.array([-speed, 0.0, 0.0]), speed * np.array([xi, eta, 0.0]), np.zeros(3)
    spin = np.array([0.0, 0.0, speed * phi])
    return RigidMotion(Twist(flow + 0.5 * slip, 0.5 * spin, origin), Twist(flow - 0.5 * slip, -0.5 * spin, origin))


def hertz_scale(scene: HertzScene, load: float) -> float:
    """Initial guess of the approach for a load N, m: Hertz's for a sphere of the mean relative curvature."""
    from wheelrail.bindings._contact import sphere_approach

    curvature = sum(1.0 / radius for body in (scene.upper, scene.lower) for radius in body.radii)
    modulus = 1.0 / sum((1.0 - body.nu**2) / body.E for body in (scene.upper, scene.lower))
    return sphere_approach(load, radius=2.0 / curvature, modulus=modulus)
