"""Profiles by name or file; files are read again only when they change."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from wheelrail.meshes.profiles.named import NAMES, named_profile
from wheelrail.meshes.profiles.profile import Kind, Profile


def load_profile(name: str | Path, kind: Kind, *, noise: float = 0.0, inclination: float = 0.0) -> Profile:
    """A standard profile by name, or one from a file.

    Parameters:
        name: of a standard profile, or path of a file.
        kind: "wheel" or "rail".
        noise, inclination: of a file, m and rad, as for `wheelrail.meshes.profiles.reader.read_profile`.

    Raises ValueError with the allowed names.
    """
    if str(name) in NAMES:
        if NAMES[str(name)] != kind:
            allowed = ", ".join(standard for standard, its_kind in NAMES.items() if its_kind == kind)
            raise ValueError(f"profile {name} is a {NAMES[str(name)]}, not a {kind}; allowed: {allowed}, or a file")
        return named_profile(str(name))
    if not Path(name).exists():
        raise ValueError(f"profile {str(name)!r} is neither known nor a file; allowed: {', '.join(NAMES)}, or a file")
    stat = Path(name).stat()
    return _from_file(name, kind, noise, inclination, (stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size))


@lru_cache(maxsize=16)
def _from_file(name: str | Path, kind: Kind, noise: float, inclination: float, stamp: tuple[int, ...]) -> Profile:
    """Cached by the file's stamp, as profiles are read both to check a scene and to use it."""
    from wheelrail.meshes.profiles.reader import read_profile

    return read_profile(name, kind, noise=noise, inclination=inclination)
