"""Forces of strips and of the standard contact at drawn positions of a wheelset, some of them wild, as bits.

python tests/helpers/contact_poses.py COUNT [FIRST]
"""

from __future__ import annotations

import hashlib
import sys

import numpy as np
from small_strips import few_strips
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.wheelset_state import WheelsetState

WILD = (np.nan, np.inf, 1e300, -0.3)  # m or rad


def states(count: int) -> list[WheelsetState]:
    """Positions from flange to flange with some 0.1 mm of overlap; every tenth has one wild number."""
    rng, drawn = np.random.default_rng(7), []
    for n in range(count):
        numbers = {
            "y": rng.uniform(-7e-3, 7e-3),
            "z": rng.uniform(-2.5e-4, 2e-5),
            "roll": rng.uniform(-1e-3, 1e-3),
            "yaw": rng.uniform(-2e-2, 2e-2),
        }
        if n % 10 == 9:
            numbers[list(numbers)[n // 10 % 4]] = WILD[n // 40 % 4]
        drawn.append(WheelsetState(**numbers, speed=20.0, pitch_rate=20.0 / 0.46))
    return drawn


def digest(count: int, first: int = 0) -> str:
    """Statuses from a first of so many positions, and a hash of forces, moments and tangents."""
    said, bits = [], hashlib.sha256()
    for contact in (wheel_on_rail(tangential="fastsim"), few_strips(strips=4, cells=6)):
        for state in states(count)[first:]:
            for side in ("left", "right"):
                result = contact(state, side)
                said.append(result.status[:1])
                if result.ok and result.status != "separated":
                    bits.update(np.array([*result.force, *result.moment]).tobytes())
                    bits.update(np.array(contact.tangent(state, side, result)).tobytes())
                    bits.update(np.array([patch.area for patch in result.patches]).tobytes())
    return "".join(said) + " " + bits.hexdigest()


if __name__ == "__main__":
    print(digest(*map(int, sys.argv[1:])))
