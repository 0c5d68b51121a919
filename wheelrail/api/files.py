"""Scenes, profiles and results from files."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.api.arguments import check_keys
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene, load_scene
from wheelrail.support.text_file import present

if TYPE_CHECKING:
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.runs import Run
    from wheelrail.api.solution import Solution
    from wheelrail.api.studies import Study
    from wheelrail.api.wear import Wear
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.meshes.profiles.profile import Kind, Profile

log = logging.getLogger(__name__)
CHANGES = ("scale", "shift", "mirror", "flip")  # of the points of a profile file, in this order


def load(scene: str | Path) -> Hertz | Wheelset:
    """Hertz pair or wheelset of a scene file; `solve()` without arguments solves the contact of the scene.

    Parameters:
        scene: scene file (TOML) of kind "hertz" or "wheelset".

    Raises SceneError naming file, key, value and what is allowed; also for a vehicle run (use `wheelrail.run`).
    """
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.wheelset import SECTIONS, Wheelset

    checked = load_scene(scene)
    if isinstance(checked, RunScene):
        raise SceneError(f'{scene}: kind = "run": must be "hertz" or "wheelset"; for a vehicle run use wheelrail.run')
    keys: dict[str, Any] = checked.model_dump(exclude_unset=True)
    del keys["kind"]
    if not isinstance(checked, WheelsetScene):
        return Hertz(**keys)
    for section in SECTIONS:
        keys |= keys.pop(section)
    return Wheelset(**keys)


def open(file: str | Path) -> Solution | Run | Study | Wear:
    """Read results from a NetCDF file.

    Parameters:
        file: written by `to_netcdf`, or run.nc, study.nc or wear.nc of the command line.

    Raises SceneError for a file without results of wheelrail, FileNotFoundError.
    """
    from wheelrail.api.runs import Run
    from wheelrail.api.solution import Solution
    from wheelrail.api.studies import Study
    from wheelrail.api.wear import Wear
    from wheelrail.scenes.datasets.contact import check_contact
    from wheelrail.scenes.datasets.netcdf import read
    from wheelrail.scenes.datasets.run_file import run_of
    from wheelrail.scenes.studies.results import KIND, check_study_data

    if not present(Path(file)):
        raise FileNotFoundError(f"{file}: file does not exist")
    data = read(Path(file))
    if "point" in data.dims and "patches" in data:
        check_contact(data, Path(file))
        return Solution(data)
    if data.attrs.get("kind") == KIND:
        check_study_data(data, Path(file))
        return Study(data)
    if {"step", "removed_area"} <= {*data.dims, *data.data_vars}:
        return Wear(data)
    if "time" in data.dims and "patches" in data:
        return Run(run_of(data, Path(file)))
    raise SceneError(f"{file}: must be the results of a contact solution, a vehicle run, a study or wear of wheelrail")


def report(folder: str | Path, file: str | Path | None = None, *, view: bool = True) -> Path:
    """Write a self-contained HTML report of a run, a study or a comparison; returns its path.

    Parameters:
        folder: results of a run, a study, wear or a comparison.
        file: the report; report.html in the folder by default.
        view: whether to include the interactive 3D view, some MB.

    Raises SceneError for a folder without results or with damaged ones, OSError.
    """
    from wheelrail.scenes.html_report.write import write_report

    return write_report(folder, file, view=view)


def profile(
    name: str | Path,
    kind: Kind | None = None,
    *,
    noise: float | None = None,
    rolling_circle: float | None = None,
    section: int | None = None,
    inclination: float = 0.0,
    **changes: Any,
) -> Profile:
    """Profile of a wheel or a rail, lengths in m.

    Parameters:
        name: "S1002", "60E1" or "UIC60", "UIC60-benchmark", or a file: Simpack .prr and .prw, MiniProf .ban and .whl,
            columns y, z in any other text.
        kind: "wheel" or "rail"; required where neither the name nor the suffix says it.
        noise: RMS distance of the smoothed curve from the points, m; 0 interpolates; by default the noise that is
            estimated from the points, where its effect is noticeable.
        rolling_circle: y of the rolling circle in the file of a wheel, m.
        section: number of the section of a file with several ones, from 1.
        inclination: of the rail that the file already contains, rad.
        changes: of the points of the file, in this order: scale, a factor; shift, (y, z) in m; mirror and flip, whether
            the sign of y, z changes: True, False, or as recognised.

    Noise, spacing, the recognised convention and remarks on the file are in the profile's `measurement`, and logged
    (`logging`, level INFO). Raises ValueError naming file, line, value and what is allowed.
    """
    from wheelrail.meshes.profiles.formats import KIND_OF_SUFFIX
    from wheelrail.meshes.profiles.library import load_profile
    from wheelrail.meshes.profiles.named import NAMES

    kind = kind or NAMES.get(str(name)) or KIND_OF_SUFFIX.get(Path(name).suffix.lower())
    if kind is None:
        from wheelrail.meshes.profiles.profile import KINDS

        if not Path(name).is_file():
            names = ", ".join(NAMES)
            raise ValueError(f"profile {str(name)!r}: must be one of {names}, or a file that exists")
        raise ValueError(f"profile {str(name)!r}: kind is missing, must be {' or '.join(map(repr, KINDS))}")
    check_keys("profile", changes, CHANGES)
    options = {"noise": noise, "rolling_circle": rolling_circle, "section": section, "inclination": inclination}
    read = load_profile(name, kind, **options, **changes)
    if read.measurement is not None:
        log.info("%s", read.measurement)
    return read
