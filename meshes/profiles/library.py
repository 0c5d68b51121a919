"""Profiles by name or file, each read once while its file stays as it is."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from wheelrail.meshes.profiles.named import NAMES, named_profile
from wheelrail.meshes.profiles.profile import Kind, Profile


def load_profile(name: str | Path, kind: Kind, *, noise: float = 0.0, inclination: float = 0.0) -> Profile:
    """A standard profile by name, or one from a file (see `wheelrail.meshes.profiles.reader.read_profile`).

    ValueError naming what is allowed.
    """
    if str(name) in NAMES:
        if NAMES[str(name)] != kind:
            allowed = ", ".join(other for other, its in NAMES.items() if its == kind)
            raise ValueError(f"profile {name} is a {NAMES[str(name)]}, not a {kind}; allowed: {allowed}, or a file")
        return named_profile(str(name))
    if not Path(name).exists():
        raise ValueError(f"profile {str(name)!r} is neither known nor a file; allowed: {', '.join(NAMES)}, or a file")
    stat = Path(name).stat()
    return _from_file(name, kind, noise, inclination, (stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size))


@lru_cache(maxsize=16)
def _from_file(name: str | Path, kind: Kind, noise: float, inclination: float, stamp: tuple[int, ...]) -> Profile:
    """Read once as long as the file stays as it is: a scene is checked with its profiles, and then uses them."""
    from wheelrail.meshes.profiles.reader import read_profile

    return read_profile(name, kind, noise=noise, inclination=inclination)
