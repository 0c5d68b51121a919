"""Completed and interrupted runs of a folder, and the check whether a scene can resume a run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.builders.vehicle_file import vehicle_text
from wheelrail.scenes.datasets.run_file import CHECKPOINTS, RESULTS
from wheelrail.scenes.runs.used_keys import used_keys
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene
from wheelrail.scenes.schema.toml import read_text
from wheelrail.support.cache import source_digest
from wheelrail.support.text_file import json_value, present, read_bytes

if TYPE_CHECKING:
    from wheelrail.scenes.runs.checkpoint_file import CheckpointFile
    from wheelrail.vehicle.simulation.checkpoint import Checkpoint

ROOT = Path(__file__).parents[2]
PACKAGES = ("support", "meshes", "forms", "contact", "vehicle", "scenes")
MOST, FILE = 10_000.0, "a file"  # MB, of the files of a scene
FREE = ("output.figures", "solver.workers")  # keys that may differ: they do not change the results


def header(scene: RunScene, vehicle: Path | None = None) -> dict[str, Any]:
    """Header of a run's checkpoint file: the scene, and the versions that compute it; vehicle: its file."""
    from wheelrail.support.version import versions

    return {"versions": versions() | {"sources": sources()}, "scene": inputs(scene, vehicle)}


def inputs(scene: RunScene, vehicle: Path | None = None) -> dict[str, Any]:
    """The keys that a run uses, with files replaced by the hash of their content.

    Parameters:
        scene: of the run.
        vehicle: file of the vehicle in three dimensions that runs in place of the wagon of the scene.
    """

    def plain(value: Any) -> Any:
        if isinstance(value, str) and present(Path(value)) and Path(value).is_file():
            return f"a file of SHA-256 {hashlib.sha256(read_bytes(value, MOST, FILE)).hexdigest()[:12]}"
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        return value

    data: dict[str, Any] = plain(used_keys(scene))
    if vehicle is not None:
        speed = {key: data["vehicle"][key] for key in ("speed", "free_speed")}
        data["vehicle"] = {**speed, "file": plain(str(vehicle))}
        if (text := vehicle_text(vehicle)) != read_text(vehicle):  # names files of coupled vehicles
            data["vehicle"]["files"] = hashlib.sha256(text.encode()).hexdigest()[:12]
    return data


def sources() -> str:
    """Hash of the source files of this package, which change more often than its version."""
    return source_digest(*(ROOT / package for package in PACKAGES))


def differences(old_table: Mapping[str, Any], new_table: Mapping[str, Any], prefix: str = "") -> Iterator[str]:
    """Keys of tables that differ, with both values."""
    for key in {**old_table, **new_table}:
        old, new, name = old_table.get(key), new_table.get(key), prefix + key
        if isinstance(old, dict) and isinstance(new, dict):
            yield from differences(old, new, name + ".")
        elif old != new and name not in FREE:
            yield f"{name}: {json.dumps(old)} before, {json.dumps(new)} now"


def ended(scene: RunScene, folder: Path, vehicle: Path | None = None) -> bool:
    """Whether a folder contains the results of the completed run; raises SceneError for those of another scene.

    Parameters:
        scene: of the run.
        folder: of the results.
        vehicle: its file, if any.
    """
    from wheelrail.scenes.datasets.netcdf import read

    file = folder / RESULTS
    if (folder / CHECKPOINTS).exists() or not file.exists():
        return False
    try:
        attributes = read(file).attrs
        stored_inputs = json_value(str(attributes.get("inputs", "{}")))
    except ValueError:  # damaged results are recomputed
        return False
    if attributes.get("status") != "completed" or not isinstance(stored_inputs, dict):
        return False
    require_same(stored_inputs, inputs(scene, vehicle), file)
    return True


def require_same(old_table: Mapping[str, Any], new_table: Mapping[str, Any], file: Path) -> None:
    """Raises SceneError naming the keys that differ."""
    if changes := list(differences(old_table, new_table)):
        raise SceneError(f"{'; '.join(changes)}: {file} belongs to another run; omit --resume to start a new one")


def latest(file: CheckpointFile, report: Callable[[str], None]) -> Checkpoint | None:
    """The checkpoint to continue from, which is reported; None when there is none.

    Raises SceneError for a checkpoint of another scene or of another version of this package, OSError.
    """
    from wheelrail.scenes.runs.checkpoint_file import read_header

    stored, checkpoint = read_header(file.path), None
    if stored is not None:
        require_same(stored["scene"], file.header["scene"], file.path)
        old, new = stored["versions"], file.header["versions"]
        require_same({"wheelrail": old.get("wheelrail")}, {"wheelrail": new["wheelrail"]}, file.path)
        checkpoint = file.latest()
        if checkpoint is not None and (changes := list(differences(old, new))):
            report(f"{'; '.join(changes)}: the last bits of the results may differ")
    if checkpoint is None:
        report(f"no checkpoint in {file.path.parent}: the run starts from the beginning")
    else:
        report(f"the run continues from the checkpoint at {checkpoint.time:.6g} s")
    return checkpoint
