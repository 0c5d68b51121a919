"""Contact models of a pair of bodies, ready to call: one builder for each kind of model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.geometry.grid_points import SurfacePair
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.profile_bodies import ProfileBodies
from wheelrail.contact.models.quadric_bodies import Blocks, QuadricBodies
from wheelrail.meshes.profiles.profile import Profile

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.solid_body import ElasticBody
    from wheelrail.contact.models.full.model import FullContact


class BodyPair(Protocol):
    """Wheel (upper body) and rail (lower body), discretised for each kind of model."""

    @property
    def materials(self) -> tuple[Material, Material]:
        """Of both bodies."""

    def half_space_strips(self, how: Discretisation) -> StripOperators:
        """Compliance of strips on half-spaces."""

    def waveguide_strips(self, how: Discretisation) -> StripOperators:
        """Compliance of strips on bodies by wavenumbers."""

    def waveguide_grids(self, how: Discretisation) -> tuple[SurfacePair, Compliance, Compliance]:
        """Surfaces, and the compliance of both bodies on their grids, by wavenumbers."""

    def solid_grids(self, how: Discretisation) -> tuple[SurfacePair, Compliance, Compliance]:
        """Surfaces, and the compliance of both meshed solids on their grids."""

    def solid_bodies(self, how: Discretisation) -> tuple[SurfacePair, ElasticBody, ElasticBody]:
        """Surfaces and stiffness of both meshed solids, split over the ranks of `mpirun`."""


def _half_space_lattice(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> LatticeContact:
    return LatticeContact(pair.half_space_strips(how), laws, how.resolution)


def _waveguide_lattice(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> LatticeContact:
    return LatticeContact(pair.waveguide_strips(how), laws, how.resolution)


def _waveguide_grid(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> CondensedContact:
    return CondensedContact(*pair.waveguide_grids(how), laws, order=how.slip_order, modulus=_modulus(pair))


def _solid_condensed(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> CondensedContact:
    return CondensedContact(*pair.solid_grids(how), laws, order=how.slip_order, modulus=_modulus(pair))


def _solid_full(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> FullContact:
    from wheelrail.contact.models.full.model import FullContact

    return FullContact(*pair.solid_bodies(how), laws, order=how.slip_order, modulus=_modulus(pair))


def _modulus(pair: BodyPair) -> float:
    return modulus(*((material.E, material.nu) for material in pair.materials))


# By model, bodies and points.
BUILDERS: Mapping[tuple[str, str | None, str | None], Callable[[BodyPair, ContactLaws, Discretisation], Any]] = {
    ("condensed", "half-space", "lattice"): _half_space_lattice,
    ("condensed", "waveguide", "lattice"): _waveguide_lattice,
    ("condensed", "waveguide", "grid"): _waveguide_grid,
    ("condensed", "solid", "grid"): _solid_condensed,
    ("full", "solid", "grid"): _solid_full,
}


def contact_model(pair: BodyPair, laws: ContactLaws, how: Discretisation) -> Any:
    """Contact model of a pair, a frozen dataclass: `dataclasses.replace` sets its further options.

    Parameters:
        pair: the bodies.
        laws: of the interface.
        how: discretisation; choices that are None depend on the laws.

    Returns `LatticeContact`, `CondensedContact` or `FullContact`. Raises IncompatibleChoice.
    """
    how = how.for_laws(exact=laws.exact_normal)
    return BUILDERS[how.model, how.bodies, how.points](pair, laws, how)


def with_laws(model: Any, laws: ContactLaws) -> Any:
    """A model of a builder with other laws on the same bodies, of the same compliance."""
    return model.with_laws(laws) if isinstance(model, LatticeContact) else replace(model, laws=laws)


def hertz_pair(
    radii: tuple[tuple[float, float], tuple[float, float]],
    materials: tuple[Material, Material],
    laws: ContactLaws,
    how: Discretisation,
    *,
    load: float | None = None,
    approach: float | None = None,
    blocks: Blocks | None = None,
) -> Any:
    """Contact model of two quadratic surfaces on large blocks.

    Parameters:
        radii: principal radii in x and y of the upper and of the lower body, m; inf is straight, negative is hollow.
        materials: of the upper and of the lower body.
        laws, how: as for `contact_model`.
        load: N, or approach: m, for which the meshed surface is large enough.
        blocks: their size and the grading of their meshes; by default at least 40 times as wide as the patch: the
            compliance missing to a half-space is about 1 % of the approach.

    Raises ValueError for radii without a point contact, IncompatibleChoice.
    """
    pair = QuadricBodies(radii, materials, laws, load=load, approach=approach, blocks=blocks or Blocks())
    return contact_model(pair, laws, how)


def wheel_rail_pair(
    profiles: tuple[Profile, Profile],
    radius: float,
    materials: tuple[Material, Material],
    laws: ContactLaws,
    how: Discretisation,
) -> Any:
    """Contact model of the left-hand pair of a wheel and a rail.

    Parameters:
        profiles: of the wheel, and of the rail as laid.
        radius: nominal rolling radius of the wheel, m.
        materials: of wheel and rail.
        laws, how: as for `contact_model`.

    Raises ValueError for profiles that do not match the standard wheel's or rail's section, IncompatibleChoice.
    """
    return contact_model(ProfileBodies(profiles, radius, materials), laws, how)
