"""Laws of the interface and materials of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from wheelrail.scenes.schema.profiles import Side
from wheelrail.scenes.schema.scene import HertzScene, OnRails

if TYPE_CHECKING:
    from wheelrail.contact.geometry.rigid_surfaces import RigidPair
    from wheelrail.contact.laws.friction import FrictionLaw
    from wheelrail.contact.laws.material import Material
    from wheelrail.contact.laws.parameters import ContactLaws
    from wheelrail.contact.models.standard.model import StandardContact


class ElasticConstants(Protocol):
    """An object with Young's modulus, Pa, and Poisson's ratio."""

    @property
    def E(self) -> float: ...
    @property
    def nu(self) -> float: ...


def material(body: ElasticConstants) -> Material:
    """Material with the elastic constants of a table of the scene."""
    from wheelrail.contact.laws.material import Material

    return Material(body.E, body.nu)


def laws(scene: HertzScene | OnRails, side: Side = "left") -> ContactLaws:
    """Contact laws of a scene on one side: penalty and regularised Coulomb friction, or the exact laws.

    The standard contact uses the friction of the exact laws.
    """
    from wheelrail.contact.laws.parameters import ContactLaws

    friction = friction_law(scene, side)
    if scene.laws == "exact" or not scene.has_elements:
        return ContactLaws(friction=friction)
    normal = scene.stiffness_per_area if scene.normal_law is None else scene.normal_law.instance
    return ContactLaws(normal, friction, scene.regularisation)


def friction_law(scene: HertzScene | OnRails, side: Side = "left") -> FrictionLaw:
    """Friction law of a scene on one side: the law of a table, or Coulomb's, constant or decreasing with the slip
    velocity.
    """
    from wheelrail.contact.laws.friction import Coulomb, FallingFriction

    friction = scene.friction if isinstance(scene, HertzScene) else scene.side(side).friction
    assert friction is not None
    if not isinstance(friction, float | int):
        return friction.instance
    if scene.falling is None or not friction:
        return Coulomb(friction)
    return FallingFriction(friction, scene.falling.share, scene.falling.rate)


def standard_contact(
    scene: HertzScene | OnRails,
    surfaces: RigidPair,
    upper: ElasticConstants,
    lower: ElasticConstants,
    side: Side = "left",
) -> StandardContact:
    """Approximate contact of multibody codes between two surfaces.

    Parameters:
        scene: friction, normal and tangential theories.
        surfaces: rigid surfaces of both bodies.
        upper, lower: elastic constants of the bodies.
        side: of a wheelset, whose friction is taken.
    """
    from wheelrail.contact.models.standard.model import StandardContact

    theories = {key: value for key in ("normal", "tangential") if (value := getattr(scene, key)) is not None}
    return StandardContact(surfaces, laws(scene, side), material(upper), material(lower), **theories)
