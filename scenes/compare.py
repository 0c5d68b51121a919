"""One scene with its own contact model and with another one: both runs, pictures of both on one axis, differences."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from scenes.complaint import RunFailed
from scenes.run import RESULTS, run_scene
from scenes.scene import RunScene, SceneError, parse_scene

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from xarray import Dataset

    from scenes.differences import Difference

TABLE = "differences.json"


@dataclass(frozen=True)
class Comparison:
    """Names of both models, differences of the second to the first, and the files that were written."""

    names: tuple[str, str]
    differences: list[Difference]
    files: tuple[Path, ...]

    def summary(self) -> list[RenderableType]:
        from scenes.differences import table

        return [table(self.differences, self.names), "\n".join(f"  {file}" for file in self.files)]


def compare_scene(file: Path, text: str, other: str, folder: Path, console: Console) -> Comparison:
    """Run a scene, and once more with another model, each in a folder of its own within the folder, and compare.

    A run that was completed there from the same text is not repeated. Raises SceneError where a scene allows no such
    model, RunFailed for a run without results, OSError when the folder cannot be written.
    """
    given = _scene(text, file)
    changed = with_model(text, other)
    if given.model == other:
        raise SceneError(f'{file}: model = "{other}": nothing to compare it with, choose another model')
    second = _scene(changed, f"{file} with model = {other!r}")
    runs = tuple(
        _run(scene, source, folder / scene.model, console) for scene, source in ((given, text), (second, changed))
    )
    names = (given.model, second.model)
    from scenes.compare_figures import draw_comparison
    from scenes.differences import differences, rows

    found = differences(runs[0], runs[1])
    with console.status("pictures of both"):
        files = list(draw_comparison((runs[0], runs[1]), names, folder))
    table = folder / TABLE
    table.write_text(json.dumps({"first": names[0], "second": names[1], "channels": rows(found)}, indent=1) + "\n")
    return Comparison(names, found, (*files, table))


def with_model(text: str, model: str) -> str:
    """The text of a scene with another model, at its top, where TOML has the keys of no table."""
    head, bracket, tables = text.partition("\n[")
    line = f'model = "{model}"'
    head, count = re.subn(r"(?m)^\s*model\s*=.*$", line, head, count=1)
    return (head if count else f"{line}\n{head}") + bracket + tables


def _scene(text: str, name: str | Path) -> RunScene:
    scene = parse_scene(text, name)
    if not isinstance(scene, RunScene):
        raise SceneError(f'{name}: kind = "{scene.kind}": only vehicle runs are compared, kind = "run"')
    return scene


def _run(scene: RunScene, text: str, folder: Path, console: Console) -> Dataset:
    """Results of a scene: those of an earlier run of the same text that was completed, or of a new one."""
    from xarray import load_dataset

    file = folder / RESULTS
    if file.is_file():
        known = load_dataset(file, decode_times=False)
        if known.attrs.get("scene") == text and known.attrs.get("status") == "completed":
            console.print(f"{scene.model}: {file} holds this run already", highlight=False)
            return known
    console.print(f"{scene.model}:", highlight=False)
    outcome = run_scene(scene, text, folder, console)
    if outcome.status == "interrupted":
        raise KeyboardInterrupt
    if not outcome.files:
        raise RunFailed(f"{scene.model}: {outcome.status}")
    console.print(f"{scene.model}: {outcome.status}", highlight=False)
    return load_dataset(file, decode_times=False)
