"""One scene with its own contact model and with another one: both runs, pictures of both on one axis, differences."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.runs.files import CHECKPOINTS, RESULTS
from wheelrail.scenes.runs.resume import ended
from wheelrail.scenes.runs.run import run_scene
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import ELEMENTS, RunScene, parse_scene
from wheelrail.support.atomic_file import atomic_file

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from xarray import Dataset

    from wheelrail.scenes.datasets.run_differences import RunDifference

TABLE = "differences.json"


@dataclass(frozen=True)
class Comparison:
    """Names of both models, differences of the second to the first, how far their energies balance (None: not known),
    and the files that were written.
    """

    names: tuple[str, str]
    differences: list[RunDifference]
    energy: tuple[float | None, float | None]
    files: tuple[Path, ...]

    def summary(self) -> list[RenderableType]:
        from wheelrail.scenes.datasets.run_differences import table

        told = [
            f"{name}: energy balances within {100.0 * error:.2g} % of the largest work"
            for name, error in zip(self.names, self.energy, strict=True)
            if error is not None
        ]
        return [table(self.differences, self.names), "\n".join([*told, *(f"  {file}" for file in self.files)])]


def compare_scene(file: Path, text: str, other: str, folder: Path, console: Console) -> Comparison:
    """Run a scene, and once more with another model, each in a folder of its own within the folder, and compare.

    A run that was completed there is not repeated, one that was stopped goes on. Raises SceneError where a scene allows
    no such model, RunFailed for a run without results, OSError when the folder cannot be written.
    """
    given = _scene(text, file)
    if given.model == other:
        raise SceneError(f'{file}: model = "{other}": nothing to compare it with, choose another one')
    changed = with_model(text, other)
    second = _scene(changed, f"{file} with model = {other!r}")
    one, two = (
        _run(scene, source, folder / scene.model, console) for scene, source in ((given, text), (second, changed))
    )
    names = (given.model, second.model)
    from wheelrail.scenes.datasets.run_differences import differences, noise, rows
    from wheelrail.scenes.plots.comparison import draw_comparison

    found = differences(one, two)
    energy = one.attrs.get("energy_balance_error"), two.attrs.get("energy_balance_error")
    with console.status("pictures of both"):
        files = list(draw_comparison((one, two), names, folder))
    table = folder / TABLE
    report = {
        "first": names[0],
        "second": names[1],
        "energy_balance_error": energy,
        "scatter": {name: noise(data) for name, data in zip(names, (one, two), strict=True)},
        "channels": rows(found),
    }
    with atomic_file(table) as part:
        part.write_text(json.dumps(report, indent=1) + "\n")
    return Comparison(names, found, energy, (*files, table))


def with_model(text: str, model: str) -> str:
    """The text of a scene with another model, at its top, where TOML has the keys of no table; the standard one gets
    none of the keys of elastic bodies.
    """
    head, bracket, tables = text.partition("\n[")
    gone = ("model", *(ELEMENTS if model == "standard" else ()))
    kept = [line for line in head.splitlines() if line.partition("=")[0].strip() not in gone]
    return "\n".join([f'model = "{model}"', *kept]) + bracket + tables


def _scene(text: str, name: str | Path) -> RunScene:
    scene = parse_scene(text, name)
    if not isinstance(scene, RunScene):
        raise SceneError(f'{name}: kind = "{scene.kind}": only vehicle runs are compared, kind = "run"')
    return scene


def _run(scene: RunScene, text: str, folder: Path, console: Console) -> Dataset:
    """Results of a scene: those that the folder holds, or of a run, which goes on where an earlier one stopped."""
    from xarray import load_dataset

    def say(what: str) -> None:
        console.print(f"{scene.model}: {what}", highlight=False, markup=False)

    results = folder / RESULTS
    try:
        if ended(scene, folder):
            say(f"{results} holds this run already")
            return load_dataset(results, decode_times=False)
        say("running")
        outcome = run_scene(scene, text, folder, console, resume=(folder / CHECKPOINTS).exists())
    except SceneError as error:  # what the folder holds is of another scene
        say(f"anew: {error}")
        outcome = run_scene(scene, text, folder, console)
    if outcome.status == "interrupted":
        raise KeyboardInterrupt
    if not outcome.files:
        raise RunFailed(f"{scene.model}: {outcome.status}")
    say(outcome.status)
    return load_dataset(results, decode_times=False)
