"""Laws of the interface and materials of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from wheelrail.scenes.schema.scene import HertzScene, RunScene, WheelsetScene

if TYPE_CHECKING:
    from wheelrail.contact.geometry.rigid_surfaces import RigidPair
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


def laws(scene: HertzScene | WheelsetScene | RunScene) -> ContactLaws:
    """Contact laws of a scene: penalty and regularised Coulomb friction, or the exact laws.

    The standard contact uses the friction of the exact laws.
    """
    from wheelrail.contact.laws.friction import Coulomb, FallingFriction
    from wheelrail.contact.laws.parameters import ContactLaws

    falls = scene.falling is not None and scene.friction > 0.0
    friction = (
        FallingFriction(scene.friction, scene.falling.share, scene.falling.rate)
        if scene.falling is not None and falls
        else Coulomb(scene.friction)
    )
    if scene.laws == "exact" or scene.model == "standard":
        return ContactLaws(friction=friction)
    return ContactLaws(scene.stiffness_per_area, friction, scene.regularisation)


def standard_contact(
    scene: HertzScene | WheelsetScene | RunScene, surfaces: RigidPair, upper: ElasticConstants, lower: ElasticConstants
) -> StandardContact:
    """Approximate contact of multibody codes between two surfaces.

    Parameters:
        scene: friction, normal and tangential theories.
        surfaces: rigid surfaces of both bodies.
        upper, lower: elastic constants of the bodies.
    """
    from wheelrail.contact.models.standard.model import StandardContact

    theories = {key: value for key in ("normal", "tangential") if (value := getattr(scene, key)) is not None}
    return StandardContact(surfaces, laws(scene), material(upper), material(lower), **theories)
