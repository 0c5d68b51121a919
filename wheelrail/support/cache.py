"""Arrays stored on disk under a hash of all their parameters, with a hash of their content, verified on reading."""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.cache_home import provide_cache_home

FORMAT = 3  # to be increased when the meaning of stored arrays changes

Arrays = Mapping[str, NDArray[Any]]


def cache_folder() -> Path:
    """Folder of the cache to which arrays are written."""
    return cache_folders()[0]


def cache_folders() -> list[Path]:
    """Folders in which arrays are looked for: those of $WHEELRAIL_CACHE, separated as in $PATH, or the user's own."""
    chosen = [Path(folder) for folder in os.environ.get("WHEELRAIL_CACHE", "").split(os.pathsep) if folder]
    if chosen:
        return chosen
    import platformdirs

    provide_cache_home()
    return [Path(platformdirs.user_cache_dir("wheelrail"))]


def digest(**parts: Any) -> str:
    """Hash of named numbers, strings, tuples, dictionaries and arrays; floats to 11 digits, arrays to 1e-11."""

    def plain(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            exact = np.round(value, 11) + 0.0 if value.dtype.kind == "f" else value
            return [str(value.dtype), value.shape, hashlib.sha256(np.ascontiguousarray(exact).tobytes()).hexdigest()]
        if isinstance(value, np.generic):
            return plain(value.item())
        if isinstance(value, float):
            return f"{value:.10e}"
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, list | tuple):
            return [plain(item) for item in value]
        if value is None or isinstance(value, str | int):
            return value
        raise TypeError(f"cannot hash a {type(value).__name__}")

    text = json.dumps({"format": FORMAT, **plain(parts)}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


@cache
def source_digest(*folders: Path, suffixes: tuple[str, ...] = (".py", ".hpp")) -> str:
    """Hash of all files of some kinds in folders, at any depth, by name and content, at the first call."""
    checksum = hashlib.sha256()
    for folder in folders:
        for file in sorted(file for file in folder.rglob("*") if file.suffix in suffixes):
            checksum.update(file.name.encode())
            checksum.update(file.read_bytes())
    return checksum.hexdigest()[:12]


def load(name: str) -> dict[str, NDArray[Any]] | None:
    """Stored arrays, or None if missing or damaged.

    Arrays of another folder than the first are stored in the first, too.
    """
    for number, folder in enumerate(cache_folders()):
        arrays = _read(name, folder)
        if arrays is not None:
            if number > 0:
                store(name, arrays)
            return arrays
    return None


def _read(name: str, folder: Path) -> dict[str, NDArray[Any]] | None:
    """Stored arrays of a folder, or None."""
    path = folder / f"{name}.npz"
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:  # np.load leaves damaged files open
            arrays = {key: stored[key] for key in stored.files}
            return arrays if stored.zip.comment == content_digest(name, arrays) else None
    except Exception:
        # Missing, unreadable or damaged: with a flipped bit zip may raise almost any exception. The caller rebuilds it.
        return None


def content_digest(name: str, arrays: Arrays) -> bytes:
    """Hash of the content of a file in the cache: its name, and names, types, shapes and elements of its arrays."""
    checksum = hashlib.sha256(name.encode())
    for key in sorted(arrays):
        values = np.ascontiguousarray(arrays[key])
        checksum.update(f"{key} {values.dtype.str} {np.shape(arrays[key])} ".encode())
        checksum.update(values.reshape(-1).view(np.uint8).data)
    return checksum.hexdigest().encode()


@contextmanager
def unstored() -> Iterator[None]:
    """No array that this process makes in the block is written, such as of bodies that wear."""
    global _unstored
    _unstored += 1
    try:
        yield
    finally:
        _unstored -= 1


_unstored = 0  # blocks


def store(name: str, arrays: Arrays) -> None:
    """Write arrays atomically, outside of `unstored`; a cache that cannot be written is a warning."""
    if _unstored:
        return
    path = cache_folder() / f"{name}.npz"
    try:
        with (
            atomic_file(path) as part,
            ZipFile(part, "w") as archive,
        ):  # as np.savez, but closed in order on a full disk
            archive.comment = content_digest(name, arrays)
            for key, values in arrays.items():
                with archive.open(f"{key}.npy", "w", force_zip64=True) as file:
                    np.save(file, values, allow_pickle=False)
    except OSError as error:
        warnings.warn(f"the cache {path.parent} cannot be written ({error}); continuing without it", stacklevel=2)


def cached(name: str, build: Callable[[], Arrays], names: Sequence[str]) -> Arrays:
    """Named arrays from the cache, or built and stored by one process while other processes wait."""

    def stored() -> Arrays | None:
        arrays = load(name)
        return arrays if arrays is not None and set(names) <= set(arrays) else None

    arrays = stored()
    if arrays is None:
        with one_process(name):
            arrays = stored()
            if arrays is None:
                arrays = dict(build())
                store(name, arrays)
    return arrays


@contextmanager
def one_process(name: str) -> Iterator[None]:
    """One process at a time in the block; all of them where files cannot be locked."""
    path, held = cache_folder() / f"{name}.lock", False
    with ExitStack() as stack:
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            while not held:
                file = stack.enter_context(path.open("w"))
                fcntl.flock(file, fcntl.LOCK_EX)  # which ends with the process
                # Its holder removes the file: a lock on one that is gone keeps nobody out.
                with suppress(FileNotFoundError):
                    held = os.path.samestat(os.fstat(file.fileno()), path.stat())
            stack.callback(path.unlink, missing_ok=True)
        yield
