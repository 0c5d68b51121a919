"""Profiles by name or file; files are read again only when they change."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.meshes.profiles.named import NAMES, named_profile
from wheelrail.meshes.profiles.profile import Kind, Profile

if TYPE_CHECKING:
    from wheelrail.meshes.profiles.reader import Reading


def load_profile(name: str | Path, kind: Kind, **options: Any) -> Profile:
    """A standard profile by name, or one from a file.

    Parameters:
        name: of a standard profile, or path of a file.
        kind: "wheel" or "rail".
        options: of a file, as for `wheelrail.meshes.profiles.reader.read_profile`.

    Raises ValueError with the allowed names.
    """
    if str(name) in NAMES:
        if NAMES[str(name)] != kind:
            allowed = ", ".join(standard for standard, its_kind in NAMES.items() if its_kind == kind)
            raise ValueError(f"profile {name} is a {NAMES[str(name)]}, not a {kind}; allowed: {allowed}, or a file")
        return named_profile(str(name))
    if not Path(name).exists():
        raise ValueError(f"profile {str(name)!r} is neither known nor a file; allowed: {', '.join(NAMES)}, or a file")
    from wheelrail.meshes.profiles.reader import Reading

    stat = Path(name).stat()
    return _from_file(name, kind, Reading(**options), (stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size))


@lru_cache(maxsize=16)
def _from_file(name: str | Path, kind: Kind, reading: Reading, stamp: tuple[int, ...]) -> Profile:
    """Profile from a file, cached by the file's stamp for both check and use of a scene."""
    from wheelrail.meshes.profiles.reader import read_profile

    return read_profile(name, kind, **vars(reading))
