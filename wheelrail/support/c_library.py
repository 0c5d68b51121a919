"""Libraries of generated functions in C: compiled by the compiler that DOLFINx uses, for the processor of the core.

They are kept in the cache, each with a hash of its content at its end: damaged ones are compiled again.
"""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import sysconfig
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from time import time
from typing import TypeVar

from wheelrail import bindings
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.cache import cache_folders
from wheelrail.support.cache_home import private, writable

T = TypeVar("T")

FOLDER = "laws"  # in the cache
# Results are those of the order in the source: the two options for vectors change traps and errno only.
OPTIONS = ("-O3", "-ffp-contract=off", "-fno-trapping-math", "-fno-math-errno", "-fPIC", "-shared")
V3 = "x86-64-v3"  # a build of the core, and the processors for which it is
UNUSED = 30 * 86400.0  # s, after which a file that was not read is removed


class CompilerFailed(OSError):
    """Missing C compiler, or failed compilation."""


def build() -> str:
    """Processors for which libraries are compiled: the core's."""
    return V3 if bindings.FOLDER.name == V3 else "baseline"


@cache
def compiler() -> list[str]:
    """Command of the C compiler: $CC, that of Python's own modules, or a usual one. Raises CompilerFailed."""
    named = os.environ.get("CC"), sysconfig.get_config_var("CC"), "cc", "gcc", "clang"
    for command in named:
        words = shlex.split(command or "")
        if words and (found := shutil.which(words[0])):
            return [found, *words[1:]]
    raise CompilerFailed("laws need a C compiler, as DOLFINx does, and there is none: install gcc, or name one in $CC")


@cache
def compiler_stamp() -> str:
    """Hash that changes with the compiler and its options. Raises CompilerFailed."""
    command = compiler()
    file = Path(command[0]).resolve()
    return hashlib.sha256(f"{command} {file} {file.stat().st_mtime_ns} {OPTIONS}".encode()).hexdigest()[:8]


def loaded(name: str, source: Callable[[], str], load: Callable[[str], T]) -> T:
    """Compiled library, from the cache or compiled now and cached if possible.

    Parameters:
        name: of the library, changes with its source.
        source: C, called unless the library is in the cache.
        load: called with the library's path, which need not exist any more afterwards.

    Raises CompilerFailed.
    """
    for folder in cache_folders():
        if _trusted(path := _place(folder, name, build())):
            return load(str(path))
    with TemporaryDirectory(prefix="wheelrail-") as place:
        made = _compiled(source(), Path(place), build())
        path = _place(cache_folders()[0], name, build())
        with suppress(OSError):
            _store(path, made)
        return load(str(path if _trusted(path) else made))


def write(name: str, source: str, folder: Path) -> None:
    """Write a library for all processors into the folder of a cache. Raises OSError, CompilerFailed."""
    for processor in (V3, "baseline") if (bindings.HERE / V3).is_dir() else ("baseline",):
        with TemporaryDirectory(prefix="wheelrail-") as place:
            _store(_place(folder, name, processor), _compiled(source, Path(place), processor))


def _place(folder: Path, name: str, processor: str) -> Path:
    return folder / FOLDER / f"{name}_{processor}.so"


def _store(path: Path, library: Path) -> None:
    """Copy a library with the hash of its content, atomically, and remove old ones. Raises OSError."""
    if not (writable(path.parent) and private(path.parent)):
        raise OSError(f"{path.parent} cannot be written by this user alone")
    content = library.read_bytes()
    with atomic_file(path) as part:
        part.write_bytes(content + hashlib.sha256(content).digest())
    for file in path.parent.glob("*.so"):
        status = file.stat()
        if time() - max(status.st_atime, status.st_mtime) > UNUSED:
            file.unlink(missing_ok=True)


def _trusted(path: Path) -> bool:
    """Whether a library is undamaged, in a folder writable by this user and the administrator only."""
    with suppress(OSError):
        sealed = path.read_bytes()
        return hashlib.sha256(sealed[:-32]).digest() == sealed[-32:] and private(path.parent)
    return False


def _compiled(source: str, folder: Path, processor: str) -> Path:
    """Library in a folder. Raises CompilerFailed."""
    file, library = folder / "law.c", folder / "law.so"
    file.write_text(source, encoding="utf-8")
    target = (f"-march={V3}",) if processor == V3 else ()
    command = [*compiler(), *OPTIONS, *target, "-o", str(library), str(file), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = next((line for line in done.stderr.splitlines() if "error" in line), f"exit code {done.returncode}")
        raise CompilerFailed(f"the C compiler {command[0]} cannot compile a law: {reason}")
    return library
