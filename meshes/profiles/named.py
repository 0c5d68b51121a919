"""Standard profiles by name."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from wheelrail.meshes.profiles.profile import Kind, Placement, Profile, from_sections

NAMES: dict[str, Kind] = {"S1002": "wheel", "60E1": "rail", "UIC60-benchmark": "rail", "UIC60": "rail"}


@lru_cache(maxsize=8)
def named_profile(name: str) -> Profile:
    """S1002 wheel, 60E1 rail (upright; UIC60 is its older name), or UIC60-benchmark rail (inclined 1/40).

    The benchmark's rail has the origin of its file, 6 um to the gauge side of the highest point and equally high to
    1e-10 m. Raises ValueError with the allowed names.
    """
    from wheelrail.meshes.profiles import standard_profiles as standards

    if name == "S1002":
        return from_sections(standards.s1002(), name=name, kind="wheel")
    if name == "UIC60":
        return named_profile("60E1")
    if name == "60E1":
        return from_sections(standards.EN_60E1.sections(), name=name, kind="rail")
    if name == "UIC60-benchmark":
        upright = from_sections(standards.BENCHMARK_UIC60.sections(), name=name, kind="rail")
        angle, shift = standards.BENCHMARK_INCLINATION, standards.BENCHMARK_SHIFT
        inclined = replace(upright.transformed(angle, shift), placement=Placement().then(angle, shift))
        return inclined.transformed(0.0, 0.0, -float(inclined.s_at_y(0.0)))
    raise ValueError(f"profile {name!r} is not known, allowed: {', '.join(NAMES)}, or a file")
