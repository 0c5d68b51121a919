"""Contact models of a scene's pair of bodies, ready to call."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance
from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide, rail_waveguide, wheel_waveguide
from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.element_correction import surface_error
from wheelrail.contact.geometry.profile_pair import ProfilePair
from wheelrail.contact.geometry.quadric_pair import QuadricPair, curvature
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.fitted.influence import ElementInfluence, HalfSpaceInfluence
from wheelrail.contact.models.fitted.model import FittedContact
from wheelrail.contact.models.fitted.operators import StripOperators
from wheelrail.contact.models.fitted.surfaces import ProfileStrips, QuadricStrips
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.meshes.bodies.extrusion import Cell, Solid
from wheelrail.meshes.bodies.outlines import rail_outline, rim_outline, wheel_outline
from wheelrail.meshes.bodies.solids import Strip, block, rail, rail_touches, wheel, wheel_touches
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array
from wheelrail.support.cache import digest

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.solid_body import ElasticBody

Model = Literal["condensed", "full"]
Bodies = Literal["solid", "waveguide", "half-space"]
Points = Literal["fitted", "grid"]
Made = TypeVar("Made")
REACH = 0.2  # m along the rolling direction, between the ends of what fitted cells can cover


def elastic_body(solid: Solid, steel: Material, degree: int) -> ElasticBody:
    """Imports dolfinx only when a stiffness is needed."""
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    return ElasticBody(solid, steel, degree=degree)


def spread_body(solid: Solid, steel: Material, degree: int) -> ElasticBody:
    """The same, split over all processes that `mpirun` started."""
    from wheelrail.contact.elasticity.solid_body import ElasticBody
    from wheelrail.support.mpi import everyone

    return ElasticBody(solid, steel, degree=degree, ranks=everyone())


def _meshed(model: Model, make: Callable[[], Made]) -> Made:
    """A mesh from the cache or gmsh; of the full model by the first process alone, and sent to the others."""
    if model != "full":
        return make()
    from wheelrail.support.mpi import everyone

    return everyone().shared(make)


def compliance(solid: Solid, key: str, steel: Material, degree: int, *, scale: float = 1.0) -> SurfaceCompliance:
    """Surface compliance of a meshed body, kept on disk under the mesh's key, the material and the degree."""
    grid = ContactGrid.on(solid, degree)
    name = digest(mesh=key, E=steel.E, nu=steel.nu, degree=degree)
    return SurfaceCompliance(name, grid.shape, partial(elastic_body, solid, steel, degree), scale=scale)


def hertz_pair(
    upper_radii: tuple[float, float],
    lower_radii: tuple[float, float],
    *,
    upper_steel: Material,
    lower_steel: Material,
    load: float | None = None,
    approach: float | None = None,
    surface_size: float,
    laws: ContactLaws,
    model: Model = "condensed",
    bodies: Bodies = "solid",
    degree: int | None = None,
    cell: Cell = "tetrahedron",
    order: int = 2,
    points: Points | None = None,
    **options: Any,
) -> ContactModel:
    """Two quadratic surfaces on large blocks, meshed for a load [N] or an approach [m] with some room to spare.

    Blocks are 40 times as wide as the patch, so the compliance that they lack is about 1 % of the approach. bodies:
    meshed solids, of displacements of degree 1 unless said otherwise, endless blocks by wavenumbers (degree 2), or
    half-spaces. points: cells "fitted" to the patch, the default for endless blocks and the exact normal law, with 12
    strips of 16 cells whatever the surface size (see `FittedContact`); or a regular "grid". Raises ValueError for radii
    that do not touch in a point, and for a full model of endless blocks. The full model is split over the ranks of
    `mpirun`.
    """
    fitted = _fitted(model, bodies, points, laws, order)
    A, B = curvature(upper_radii) + curvature(lower_radii)
    E_star = modulus((upper_steel.E, upper_steel.nu), (lower_steel.E, lower_steel.nu))
    expected = hertz(A, B, E_star, force=load, approach=approach)
    depth = 1.25 * (expected.approach + expected.peak * laws.normal_compliance)
    steps = order if laws.friction > 0 else 0
    half = [int(np.ceil(np.sqrt(depth / c) / surface_size)) + 1 for c in (A, B)]
    half_cells = (half[0] + steps, half[1])
    # in cells, and in coarse steps, so that one mesh and one compliance serve many scenes
    width = 2.0 ** np.ceil(np.log2(40 * max(expected.semi_axes) / surface_size))
    if bodies == "half-space":
        lines = np.arange(-half_cells[1], half_cells[1] + 1, dtype=np.float64) * surface_size
        flat = np.column_stack([lines, np.zeros_like(lines)])
        steels = (upper_steel,) if lower_steel == upper_steel else (upper_steel, lower_steel)
        halves = [HalfSpaceInfluence.under(flat, lines, 5 * np.sqrt(depth / A), steel) for steel in steels]
        operators = StripOperators(QuadricStrips(upper_radii, lower_radii), halves[0], halves[-1])
        return FittedContact(operators, laws, **options)
    if bodies == "waveguide":

        def endless(steel: Material) -> tuple[WaveguideCompliance, ContactGrid]:
            return block_waveguide(half_cells, steel, size=surface_size, half_width=float(width), degree=degree or 2)

        above, shared = endless(upper_steel)
        below = above if lower_steel == upper_steel else endless(lower_steel)[0]
        if fitted:
            lines, reach = shared.position[0, :, 1:], 5 * np.sqrt(depth / A)
            kernels = [
                _kernel(body, lines, lines[:, 0], reach, steel, degree, surface_size)
                for body, steel in ((above, upper_steel), (below, lower_steel))[: 1 if below is above else 2]
            ]
            operators = StripOperators(QuadricStrips(upper_radii, lower_radii), kernels[0], kernels[-1])
            return FittedContact(operators, laws, **options)
        return CondensedContact(
            QuadricPair(shared, upper_radii, lower_radii), above, below, laws, order=order, **options
        )
    degree = degree or 1
    solid, key = _meshed(model, partial(block, half_cells, half_width=float(width), cell=cell))
    grid = ContactGrid.on(solid, degree)
    scaled = ContactGrid(grid.position * surface_size, grid.weight * surface_size**2, grid.stride)
    geometry = QuadricPair(scaled, upper_radii, lower_radii)
    if model == "full":
        from wheelrail.contact.models.full.model import FullContact

        upper_body, lower_body = (
            spread_body(solid.mapped(partial(np.multiply, surface_size)), s, degree) for s in (upper_steel, lower_steel)
        )
        return FullContact(geometry, upper_body, lower_body, laws, order=order, **options)

    def of(steel: Material) -> SurfaceCompliance:
        return compliance(solid, key, Material(1.0, steel.nu), degree, scale=1 / (steel.E * surface_size))

    upper = of(upper_steel)
    lower = upper if lower_steel == upper_steel else of(lower_steel)
    return CondensedContact(geometry, upper, lower, laws, order=order, **options)


def wheel_rail_pair(
    wheel_profile: Profile,
    rail_profile: Profile,
    *,
    radius: float,
    wheel_steel: Material,
    rail_steel: Material,
    surface_size: float,
    laws: ContactLaws,
    model: Model = "condensed",
    bodies: Bodies = "solid",
    degree: int | None = None,
    cell: Cell = "tetrahedron",
    order: int = 2,
    points: Points | None = None,
    **options: Any,
) -> ContactModel:
    """Left-hand pair of a wheel of nominal radius [m] and a rail as laid, on meshes of the surface size [m].

    bodies: meshed solids, of displacements of degree 1 unless said otherwise; an endless rail and a whole wheel by
    wavenumbers (degree 2); or half-spaces, to compare with codes that know no others. points as for `hertz_pair`.
    Raises ValueError for profiles that do not fit a wheel's or rail's section, and for a full model of endless bodies.
    The full model is split over the ranks of `mpirun`.
    """
    fitted = _fitted(model, bodies, points, laws, order)
    if bodies == "half-space":
        kernels: list[HalfSpaceInfluence] = []
        for outline, ends in (
            (wheel_outline(wheel_profile, radius), wheel_touches(wheel_profile)),
            (rail_outline(rail_profile), rail_touches(rail_profile)),
        ):
            arc = Strip.over(outline, ends, half_length=surface_size, size=surface_size).arc
            steel = rail_steel if kernels else wheel_steel
            kernels.append(HalfSpaceInfluence.under(outline.surface(arc), arc, REACH, steel))
        return FittedContact(
            StripOperators(ProfileStrips(wheel_profile, rail_profile, radius), *kernels), laws, **options
        )
    if bodies == "waveguide":
        wheel_section, rail_section = wheel_outline(wheel_profile, radius), rail_outline(rail_profile)
        above, wheel_grid, wheel_strip = wheel_waveguide(
            wheel_section, wheel_steel, size=surface_size, degree=degree or 2
        )
        below, rail_grid, rail_strip = rail_waveguide(rail_section, rail_steel, size=surface_size, degree=degree or 2)
        if fitted:
            operators = StripOperators(
                ProfileStrips(wheel_profile, rail_profile, radius),
                _kernel(above, wheel_section.surface(wheel_strip.arc), wheel_strip.arc, REACH, wheel_steel, degree),
                _kernel(below, rail_section.surface(rail_strip.arc), rail_strip.arc, REACH, rail_steel, degree),
            )
            return FittedContact(operators, laws, **options)
        surfaces = ProfilePair(wheel_profile, rail_profile, radius, wheel_strip, rail_strip, wheel_grid, rail_grid)
        return CondensedContact(surfaces, above, below, laws, order=order, **options)
    degree = degree or 1
    rim = rim_outline(wheel_profile, radius)
    wheel_solid, wheel_strip, wheel_key = _meshed(model, partial(wheel, rim, size=surface_size, cell=cell))
    outline = rail_outline(rail_profile, chord_error=min(0.5 * surface_size, 5e-4))
    rail_solid, rail_strip, rail_key = _meshed(model, partial(rail, outline, size=surface_size, cell=cell))
    geometry = ProfilePair(
        wheel_profile,
        rail_profile,
        radius,
        wheel_strip,
        rail_strip,
        ContactGrid.on(wheel_solid, degree),
        ContactGrid.on(rail_solid, degree),
        degree,
    )
    if model == "full":
        from wheelrail.contact.models.full.model import FullContact

        wheel_body, rail_body = (
            spread_body(s, steel, degree) for s, steel in ((wheel_solid, wheel_steel), (rail_solid, rail_steel))
        )
        return FullContact(geometry, wheel_body, rail_body, laws, order=order, **options)
    return CondensedContact(
        geometry,
        compliance(wheel_solid, wheel_key, wheel_steel, degree),
        compliance(rail_solid, rail_key, rail_steel, degree),
        laws,
        order=order,
        **options,
    )


def _kernel(
    body: WaveguideCompliance,
    lines: Array,
    arc: Array,
    reach: float,
    steel: Material,
    degree: int | None,
    unit: float = 1.0,
) -> ElementInfluence:
    """Compliance between strips of a body, from the spectrum behind its grid."""
    return ElementInfluence(
        lines,
        arc,
        reach,
        steel.nu,
        radius=body.radius,
        unit=unit,
        scale=body.scale,
        spectrum=body.spectrum,
        error=partial(surface_error, steel.nu, degree or 2),
    )


def _fitted(model: Model, bodies: Bodies, points: Points | None, laws: ContactLaws, order: int) -> bool:
    """Whether cells are fitted. Raises ValueError for what does not go together."""
    if model == "full" and bodies != "solid":
        raise ValueError("the full model needs meshed solids")
    possible = bodies != "solid" and laws.normal_compliance == 0
    if (points == "fitted" or bodies == "half-space") and not possible:
        raise ValueError('fitted points need bodies = "waveguide" or "half-space" and the exact normal law')
    if points == "grid" and bodies == "half-space":
        raise ValueError("half-spaces have no grid, only fitted points")
    fitted = possible and points != "grid"
    if fitted and order != 2:
        raise ValueError(f"the slip of fitted points is of second order, got {order}")
    return fitted
