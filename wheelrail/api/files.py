"""Scenes, profiles and results from files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, WheelsetScene, load_scene

if TYPE_CHECKING:
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.runs import Run
    from wheelrail.api.solution import Solution
    from wheelrail.api.studies import Study
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.meshes.profiles.profile import Kind, Profile

ENDINGS: dict[str, Kind] = {".prr": "rail", ".ban": "rail", ".prw": "wheel", ".whl": "wheel"}


def load(scene: str | Path) -> Hertz | Wheelset:
    """The Hertz pair or the wheelset of a scene file (TOML); its `solve()` without arguments is the scene's contact.

    Raises SceneError naming file, key, value and what is allowed, and for a vehicle run, which `wheelrail.run` takes.
    """
    from wheelrail.api.hertz import Hertz
    from wheelrail.api.wheelset import SECTIONS, Wheelset

    found = load_scene(scene)
    if isinstance(found, RunScene):
        raise SceneError(f'{scene}: kind = "run": this is a vehicle run, use wheelrail.run')
    keys: dict[str, Any] = found.model_dump(exclude_unset=True)
    del keys["kind"]
    if not isinstance(found, WheelsetScene):
        return Hertz(**keys)
    for section in SECTIONS:
        keys |= keys.pop(section)
    return Wheelset(**keys)


def open(file: str | Path) -> Solution | Run | Study:
    """What a `to_netcdf` wrote, or the run.nc or study.nc of the command line.

    Raises SceneError for a file that is none of these, OSError for one that cannot be read.
    """
    from xarray import open_dataset

    from wheelrail.api.runs import Run
    from wheelrail.api.solution import Solution
    from wheelrail.api.studies import Study

    if not Path(file).is_file():
        raise FileNotFoundError(f"{file}: there is no such file")
    try:
        with open_dataset(file, engine="netcdf4", decode_times=False) as stored:
            data = stored.load()
    except (OSError, ValueError) as error:
        raise SceneError(
            f"{file}: not a NetCDF file that can be read ({error}); allowed: results of wheelrail"
        ) from None
    if "point" in data.dims and "patches" in data:
        return Solution(data)
    if data.attrs.get("kind") == "study":
        return Study(data)
    if "time" in data.dims and "patches" in data:
        return Run(data)
    raise SceneError(f"{file}: no contact solution, vehicle run or study; allowed: results of wheelrail")


def report(folder: str | Path, file: str | Path | None = None, *, view: bool = True) -> Path:
    """Write the page (HTML) of the run, the study or the comparison in a folder; its path.

    file: report.html in the folder unless given. The page is whole in itself and needs no network. view: with a view in
    three dimensions, some MB. Raises SceneError for a folder without results or with damaged ones, OSError.
    """
    from wheelrail.scenes.html_report.write import write_report

    return write_report(folder, file, view=view)


def profile(name: str | Path, kind: Kind | None = None, *, noise: float = 0.0, inclination: float = 0.0) -> Profile:
    """The profile of a wheel or of a rail, lengths in m: "S1002", "60E1" or "UIC60", "UIC60-benchmark", or a file.

    Files: Simpack .prr and .prw, MiniProf .ban and .whl, and points y, z in .txt, .csv or .dat, for which kind says
    whether it is a "wheel" or a "rail". noise m: RMS distance that the curve may keep from the points; 0 passes through
    them. inclination rad: laying angle that is in the file already. Raises ValueError naming file, line, value and what
    is allowed.
    """
    from wheelrail.meshes.profiles.library import load_profile
    from wheelrail.meshes.profiles.named import NAMES

    kind = kind or NAMES.get(str(name)) or ENDINGS.get(Path(name).suffix.lower())
    if kind is None:
        from wheelrail.meshes.profiles.profile import KINDS

        if not Path(name).is_file():
            known = ", ".join(NAMES)
            raise ValueError(f"profile {str(name)!r} is neither known nor a file; allowed: {known}, or a file")
        raise ValueError(f"profile {str(name)!r}: kind is missing; allowed: {' or '.join(map(repr, KINDS))}")
    return load_profile(name, kind, noise=noise, inclination=inclination)
