"""Discretisations of a wheel and a rail of given profiles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.elasticity.solid_compliance import distributed_body, solid_compliance
from wheelrail.contact.elasticity.waveguide.bodies import HALF_GRID, profile_waveguide
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence, HalfSpaceInfluence
from wheelrail.contact.geometry.profile_pair import ProfilePair
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.surface_memory import check_surface
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.meshes.bodies.outlines import rail_outline, rim_outline, wheel_outline
from wheelrail.meshes.bodies.solids import HALF_PATCH, Strip, contact_range, profiled
from wheelrail.meshes.profiles.profile import Profile

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.solid_body import ElasticBody


@dataclass(frozen=True)
class ProfileBodies:
    """Left-hand pair of a wheel and a rail as laid.

    Parameters:
        profiles: of wheel and rail.
        radius: nominal rolling radius of the wheel, m.
        materials: of wheel and rail.
    """

    profiles: tuple[Profile, Profile]
    radius: float
    materials: tuple[Material, Material]

    @property
    def _strips(self) -> ProfileStrips:
        return ProfileStrips(*self.profiles, self.radius)

    def _check_surfaces(self, how: Discretisation, half_length: float) -> None:
        """Log the memory of surface compliances for a half length [m] if large; raises TooLarge."""
        wheel_profile, rail_profile = self.profiles
        for outline in (wheel_outline(wheel_profile, self.radius), rail_outline(rail_profile)):
            strip = Strip.on(outline, half_length=half_length, size=how.surface_size)
            check_surface(f"the {outline.profile.kind}", 2 * strip.half_cells + 1, strip.cells + 1, how)

    def half_space_strips(self, how: Discretisation) -> StripOperators:
        return StripOperators(self._strips, *self._half_spaces(how.surface_size))

    def _half_spaces(self, size: float) -> Iterator[HalfSpaceInfluence]:
        """Half-spaces under the whole profiles; the wheel's lines are those of its strip, continued."""
        wheel, rail = self.profiles
        starts = contact_range(wheel)[0], rail.s_range[0]
        for profile, ordinary, material in zip(self.profiles, starts, self.materials, strict=True):
            first, last = profile.s_range
            start = max(ordinary, first + size)
            arc = start + size * np.arange(np.ceil((first - start) / size), np.floor((last - start) / size) + 1)
            yield HalfSpaceInfluence.under(profile.point(arc), arc, material)

    def waveguide_strips(self, how: Discretisation) -> StripOperators:
        return StripOperators(
            self._strips,
            *(
                ElementInfluence.of_waveguide(body, outline.surface(strip.arc), strip.arc, material, how.degree)
                for (outline, (body, _, strip)), material in zip(self._waveguides(how), self.materials, strict=True)
            ),
        )

    def waveguide_grids(self, how: Discretisation) -> tuple[ProfilePair, Compliance, Compliance]:
        (_, (above, wheel_grid, wheel_strip)), (_, (below, rail_grid, rail_strip)) = self._waveguides(how)
        surfaces = ProfilePair(*self.profiles, self.radius, wheel_strip, rail_strip, wheel_grid, rail_grid)
        return surfaces, above, below

    def _waveguides(self, how: Discretisation) -> Iterator[tuple[Any, Any]]:
        """Outline of each body, with its compliance, grid and strip. Raises TooLarge."""
        self._check_surfaces(how, HALF_GRID)
        sections = wheel_outline(self.profiles[0], self.radius), rail_outline(self.profiles[1])
        for section, material in zip(sections, self.materials, strict=True):
            yield section, profile_waveguide(section, material, size=how.surface_size, degree=how.degree)

    def solid_grids(self, how: Discretisation) -> tuple[ProfilePair, Compliance, Compliance]:
        surfaces, solids = self._solids(how, lambda build: build())
        above, below = (
            solid_compliance(solid, key, material, how.degree)
            for (solid, key), material in zip(solids, self.materials, strict=True)
        )
        return surfaces, above, below

    def solid_bodies(self, how: Discretisation) -> tuple[ProfilePair, ElasticBody, ElasticBody]:
        from wheelrail.support.mpi import world

        surfaces, solids = self._solids(how, world().broadcast)
        above, below = (
            distributed_body(solid, material, how.degree, key=key)
            for (solid, key), material in zip(solids, self.materials, strict=True)
        )
        return surfaces, above, below

    def _solids(
        self, how: Discretisation, run: Callable[[Callable[[], Any]], Any]
    ) -> tuple[ProfilePair, list[tuple[Solid, str]]]:
        """Surfaces, and both solids with their keys in the cache; run calls the mesh generation. Raises TooLarge."""
        self._check_surfaces(how, HALF_PATCH)
        size, cell, degree = how.surface_size, how.cell, how.degree
        rim = rim_outline(self.profiles[0], self.radius)
        wheel_solid, wheel_strip, wheel_key = run(partial(profiled, rim, size=size, cell=cell))
        outline = rail_outline(self.profiles[1], chord_error=min(0.5 * size, 5e-4))
        rail_solid, rail_strip, rail_key = run(partial(profiled, outline, size=size, cell=cell))
        grids = ContactGrid.on(wheel_solid, degree), ContactGrid.on(rail_solid, degree)
        surfaces = ProfilePair(*self.profiles, self.radius, wheel_strip, rail_strip, *grids, degree)
        return surfaces, [(wheel_solid, wheel_key), (rail_solid, rail_key)]
