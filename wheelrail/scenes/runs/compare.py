"""Comparison of two contact models in one vehicle run: both runs, figures, table of differences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.result_table import Results, json_text
from wheelrail.scenes.datasets.run_file import CHECKPOINTS, RESULTS
from wheelrail.scenes.runs.resume import ended
from wheelrail.scenes.runs.run import run_scene
from wheelrail.scenes.schema.errors import RunFailed, SceneError
from wheelrail.scenes.schema.scene import ELEMENTS, RunScene, parse_scene
from wheelrail.support.atomic_file import atomic_file

if TYPE_CHECKING:
    from rich.console import Console
    from xarray import Dataset

    from wheelrail.scenes.datasets.run_differences import RunDifference

TABLE = "differences.json"


@dataclass(frozen=True)
class Comparison:
    """Result of a comparison.

    Parameters:
        names: of both models.
        differences: second model minus first, by quantity.
        energy: relative error of the energy balance of both runs; None if unknown.
        scatter: RMS noise of forces by model and force, N, over the run and in the full curve.
        files: written files.
    """

    names: tuple[str, str]
    differences: list[RunDifference]
    energy: tuple[float | None, float | None]
    scatter: Mapping[str, Mapping[str, tuple[float, float]]]
    files: tuple[Path, ...]

    @property
    def results(self) -> Results:
        """Table of differences, errors of the energy balances, noise, files."""
        from wheelrail.scenes.datasets.run_differences import table

        balances = [
            f"{name}: error of the energy balance {100.0 * error:.2g} % of the largest work"
            for name, error in zip(self.names, self.energy, strict=True)
            if error is not None
        ]
        lines = "\n".join([*balances, *(f"  {file}" for file in self.files)])
        facts = {
            "first": self.names[0],
            "second": self.names[1],
            "energy_balance_error": self.energy,
            "scatter": self.scatter,
            "files": self.files,
        }
        units = {"energy_balance_error": "1", "scatter": "N"}
        return Results("compare", [table(self.differences, self.names), lines], facts, units)


def compare_scene(file: Path, text: str, other_model: str, folder: Path, console: Console) -> Comparison:
    """Simulate a run with the scene's model and with another one, and compare.

    Parameters:
        file: scene file, for messages.
        text: of the scene.
        other: the other contact model.
        folder: for results; each run has a subfolder named by its model.
        console: for progress.

    A completed run is not repeated, an interrupted one is resumed. Raises SceneError if the scene does not allow the
    other model, RunFailed for a run without results, OSError if the folder cannot be written.
    """
    first = _scene(text, file)
    if first.model == other_model:
        raise SceneError(f'{file}: model = "{other_model}": must differ from the model of --with')
    other_text = with_model(text, other_model)
    second = _scene(other_text, f"{file} with model = {other_model!r}")
    runs = (
        _run(first, text, folder / first.model, console),
        _run(second, other_text, folder / second.model, console),
    )
    names = (first.model, second.model)
    from wheelrail.scenes.datasets.run_differences import differences, noise
    from wheelrail.scenes.plots.comparison import draw_comparison

    run_differences = differences(*runs)
    energy = runs[0].attrs.get("energy_balance_error"), runs[1].attrs.get("energy_balance_error")
    with console.status("figures of both runs"):
        files = list(draw_comparison(runs, names, folder))
    table = folder / TABLE
    scatter = {str(name): noise(data) for name, data in zip(names, runs, strict=True)}
    comparison = Comparison(names, run_differences, energy, scatter, (*files, table))
    report = {key: value for key, value in comparison.results.report.items() if key != "files"}
    with atomic_file(table) as part:
        part.write_text(json_text(report, indent=1) + "\n")
    return comparison


def with_model(text: str, model: str) -> str:
    """Text of a scene with another model; keys of elastic bodies are removed for the standard model.

    The model is set in the first lines, where TOML has the top-level keys.
    """
    head, bracket, tables = text.partition("\n[")
    removed = ("model", *(ELEMENTS if model == "standard" else ()))
    lines = [line for line in head.splitlines() if line.partition("=")[0].strip() not in removed]
    return "\n".join([f'model = "{model}"', *lines]) + bracket + tables


def _scene(text: str, name: str | Path) -> RunScene:
    scene = parse_scene(text, name)
    if not isinstance(scene, RunScene):
        raise SceneError(f'{name}: kind = "{scene.kind}": must be "run"; only vehicle runs can be compared')
    return scene


def _run(scene: RunScene, text: str, folder: Path, console: Console) -> Dataset:
    """Results of a scene, stored in the folder or simulated; an interrupted run is resumed."""
    from wheelrail.scenes.datasets.run_file import read_run

    def log(message: str) -> None:
        console.print(f"{scene.model}: {message}", highlight=False, markup=False)

    results = folder / RESULTS
    try:
        if ended(scene, folder):
            log(f"{results} already contains this run")
            return read_run(results)
        log("running")
        outcome = run_scene(scene, text, folder, console, resume=(folder / CHECKPOINTS).exists())
    except SceneError as error:  # the folder contains results of another scene
        log(f"restarting: {error}")
        outcome = run_scene(scene, text, folder, console)
    if outcome.status == "interrupted":
        raise KeyboardInterrupt
    if not outcome.files:
        raise RunFailed(f"{scene.model}: {outcome.status}")
    log(outcome.status)
    return read_run(results)
