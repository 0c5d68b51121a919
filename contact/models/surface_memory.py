"""Estimate of the memory for the compliance of a surface, before anything is meshed."""

from __future__ import annotations

import logging

from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.support.memory import check_memory, factor_memory

log = logging.getLogger(__name__)

LAYERS = 3  # of nodes below the surface of a solid, at least
SAMPLES = 40  # wavenumbers of a waveguide's spectrum: 27 to 55 for blocks, rails and wheels at 0.2 to 4 mm
LARGE = 1.0  # GB, told before


def check_surface(body: str, along: int, across: int, how: Discretisation) -> None:
    """Log the memory of a surface's compliance if large.

    Parameters:
        body: its name.
        along, across: corners of the cells on the surface.
        how: discretisation, all choices made.

    Raises TooLarge for more than the machine has.
    """
    reserved = 0.0
    if how.bodies == "solid":
        nodes = float(along * across * how.degree**2)
        gigabytes, reserved = factor_memory(3 * LAYERS * nodes), 8e-9 * (3 * nodes) ** 2  # `SurfaceCompliance`
    else:  # 3 x 3 compliances of pairs of lines, at all wavenumbers twice
        pairs = 0.5 * float(across) ** 2
        gigabytes = 1e-9 * 72 * pairs * (2 * SAMPLES if how.bodies == "waveguide" else 2)
    size = f"surface_size: {along} x {across} nodes on the surface of {body}"
    check_memory(size, max(gigabytes, reserved))
    if gigabytes > LARGE:
        log.info("%s: about %.2g GB of memory or more", size, gigabytes)
