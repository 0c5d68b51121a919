"""Two bodies in contact: their surfaces and their compliance."""

from __future__ import annotations

from dataclasses import dataclass

from wheelrail.contact.elasticity.waveguide.influence import HalfSpaceInfluence
from wheelrail.contact.geometry.strip_surfaces import StripSurfaces

TOO_LONG = "the patch is longer than the tables of influence"


@dataclass(frozen=True)
class StripOperators:
    """Two bodies invariant along x or in angle, and their surfaces in contact.

    The lower body is aligned with the rolling direction: a yaw of 30 mrad rotates it by as much, which has no effect on
    a half-space.
    """

    surfaces: StripSurfaces
    upper: HalfSpaceInfluence
    lower: HalfSpaceInfluence
