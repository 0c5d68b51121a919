"""Reports: contents, display in a browser without network and without errors, atomic writing."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from study_workers import Here
from test_figures import history
from test_study import study
from typer.testing import CliRunner
from xarray import Dataset

from wheelrail.cli.main import app
from wheelrail.scenes.datasets.netcdf import machine, read, write
from wheelrail.scenes.datasets.run import dataset
from wheelrail.scenes.html_report.extremes import extreme, wheel_table
from wheelrail.scenes.html_report.provenance import seconds
from wheelrail.scenes.html_report.write import write_report
from wheelrail.scenes.studies import dataset as results
from wheelrail.scenes.studies import job as jobs
from wheelrail.scenes.studies import run as run_module
from wheelrail.scenes.studies.plan import plan
from wheelrail.scenes.studies.run import run_study
from wheelrail.scenes.studies.schema import check_study
from wheelrail.scenes.studies.solve import CaseResult, solve
from wheelrail.scenes.views import plotter as off_screen
from wheelrail.scenes.views.animation import largest_force

SCENE = (Path(__file__).parents[2] / "scenes" / "curve.toml").read_text(encoding="utf-8")
ALLOWED = "must be the folder of a run (run.nc, by wheelrail run), of a study (study.nc, by wheelrail study)"


def run_data(scale: float = 1e-3) -> Dataset:
    """Synthetic run of a shipped scene, with motions of some mm."""
    one = history()
    return dataset(replace(one, rows=[replace(row, state=scale * row.state) for row in one.rows]), scene=SCENE)


class Reader(HTMLParser):
    """Tags with their attributes, and the texts of tables' rows and captions."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.rows: list[list[str]] = []
        self.texts: list[str] = []
        self.inside: str | None = None
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {key: value or "" for key, value in attrs}))
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        self.inside = tag

    def handle_endtag(self, tag: str) -> None:
        self.inside = None

    def handle_data(self, data: str) -> None:
        if self.inside in ("td", "th"):
            self.rows[-1][-1] += data
        if self.inside not in ("script", "style"):
            self.texts.append(data)

    def of(self, tag: str) -> list[dict[str, str]]:
        return [attrs for name, attrs in self.tags if name == tag]

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).split())


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run and its report."""
    folder = tmp_path_factory.mktemp("curve <1>")
    write(run_data(), folder / "run.nc")
    outcome = CliRunner().invoke(app, ["report", str(folder)])
    assert outcome.exit_code == 0, outcome.output
    assert outcome.stdout.split("\n")[0] == str(folder / "report.html")
    return folder


@pytest.fixture(scope="module")
def run_page(run_folder: Path) -> str:
    return (run_folder / "report.html").read_text(encoding="utf-8")


# Display in a browser

WATCH = """<script>
const complaints = [];
addEventListener("error", event => complaints.push(String(event.message || event.target.tagName)), true);
let count = 0;
const timer = setInterval(() => {
  const frames = [...document.querySelectorAll("iframe")];
  const canvases = frames.flatMap(frame => [...(frame.contentDocument || document).querySelectorAll("canvas")]);
  if (++count < 60 && !(canvases.length && count > 30)) return;
  clearInterval(timer);
  const box = frames.length ? frames[0].getBoundingClientRect() : null;
  console.log("FOUND" + JSON.stringify({
    complaints, images: [...document.images].map(one => [one.alt, one.naturalWidth]),
    canvases: canvases.map(one => [one.width, one.height]), messages: document.querySelectorAll(".message").length,
    shown: document.querySelectorAll(".message:not([hidden])").length,
    tables: [...document.querySelectorAll(".long")].map(one => {
      const first = () => one.querySelector("tbody tr").textContent;
      const heads = one.querySelectorAll("button"), seen = [first()];
      for (const click of [0, 0, 1, heads.length - 1]) { heads[click].click(); seen.push(first()); }
      return [one.querySelectorAll("tbody tr").length, one.clientHeight, one.scrollHeight, ...seen];
    }),
    box: box && [box.left, box.top, box.right, box.bottom].map(Math.round),
  }) + "END");
}, 100);
</script>"""


# Known console messages of the viewer, of software rendering, and of this test.
HARMLESS = re.compile(r'"hashes,scene"|GL Driver Message \(OpenGL, Performance|"FOUND\{')


def opened(page: str, folder: Path, *flags: str) -> tuple[dict[str, Any], list[str], Any]:
    """Contents of the rendered page, errors on the console, and screenshot (pixels, colours)."""
    chromium = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    assert chromium, "this test needs Chromium: apt-get install chromium (make test does), or google-chrome"
    (folder / "watched.html").write_text(page.replace("<head>", f"<head>{WATCH}", 1), encoding="utf-8")
    command = [
        *(chromium, "--headless", "--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader"),
        *("--enable-unsafe-swiftshader", "--host-resolver-rules=MAP * ~NOTFOUND", "--no-first-run"),
        *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
        *("--window-size=1000,3600", "--virtual-time-budget=8000", "--enable-logging=stderr"),
        *(f"--user-data-dir={folder / 'browser'}", f"--screenshot={folder / 'page.png'}"),
        *flags,
        (folder / "watched.html").as_uri(),
    ]
    said = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stderr
    found = re.search(r"FOUND(\{.*\})END", said)
    assert found, said
    errors = [line for line in said.splitlines() if ":CONSOLE:" in line and not HARMLESS.search(line)]
    return json.loads(found[1].replace('\\"', '"')), errors, imread(folder / "page.png")


def test_run_page_in_a_browser(run_page: str, tmp_path: Path) -> None:
    """All figures are loaded, the view is drawn, without network access and console messages."""
    found, errors, picture = opened(run_page, tmp_path)
    assert errors == []
    assert found["complaints"] == []
    assert len(found["images"]) == 9  # eight pictures and the view's still
    assert all(width > 300 and len(alt) > 20 for alt, width in found["images"])
    assert len(found["canvases"]) == 1
    assert min(found["canvases"][0]) > 200
    assert (found["messages"], found["shown"]) == (1, 0)
    left, top, right, bottom = found["box"]
    view = np.round(255 * picture[top + 40 : bottom - 4, left + 4 : right - 4, :3]).astype(int)
    assert 0.1 < (view.min(axis=-1) < 200).mean() < 0.9
    assert len(np.unique(view.reshape(-1, 3), axis=0)) > 300


def test_still_image_without_webgl(run_page: str, tmp_path: Path) -> None:
    found, errors, _ = opened(run_page, tmp_path, "--disable-3d-apis")
    assert errors == []
    assert found["canvases"] == []
    assert found["shown"] == 1
    assert all(width > 300 for _, width in found["images"])


def test_browser_errors_are_detected(tmp_path: Path) -> None:
    """Errors of a page are detected: missing images, script errors, missing view."""
    script = "<script>console.error('this, too'); missing()</script>"
    page = f'<html><head></head><body><img alt="a" src="https://example.org/a.png">{script}</body></html>'
    found, errors, _ = opened(page, tmp_path)
    assert any("missing is not defined" in line for line in errors)
    assert any("this, too" in line for line in errors)
    assert "IMG" in found["complaints"]
    assert found["images"] == [["a", 0]]
    assert found["canvases"] == []


# Contents of a page


def test_run_page_contents(run_page: str) -> None:
    page = Reader(run_page)
    assert machine() in page.text
    assert "completed at 90.0 m" in page.text
    assert "numpy 1." in page.text or "numpy 2." in page.text
    # in the scene only: a changed copy of an example may no longer do what its first comment says
    assert page.text.count("10 s of the curve of the paper with the exact laws") == 1
    assert "wheelrail run scenes/curve.toml" in page.text  # the scene as it was written
    assert "curve <1>" in page.text  # its name, escaped
    rows = {row[0]: row[1:] for row in page.rows}
    assert rows["steps rejected"] == ["2"]
    assert rows["contact problems solved"] == ["300", "301"]
    assert rows["lateral force Y, positive to the left, largest magnitude [kN]"] == ["0", "0.0", "-20", "90.0"]
    assert rows["vertical force Q, positive upwards, minimum [kN]"][:2] == ["37", "90.0"]


def test_page_is_self_contained_and_accessible(run_page: str) -> None:
    page = Reader(run_page)
    assert not re.search(r"<(?:script|link|img|iframe|a)\b[^>]*\b(?:src|href)\s*=\s*[\"']?(?:https?:)?//", run_page)
    assert all(one["src"].startswith("data:image/") and one["alt"] for one in page.of("img"))
    assert all(one.get("scope") in ("col", "row") for one in page.of("th"))
    assert len(page.of("caption")) == len(page.of("table")) == 6
    levels = [name for name, _ in page.tags if re.fullmatch(r"h\d", name)]
    assert levels == ["h1", *["h2"] * (len(levels) - 1)]
    assert page.of("html") == [{"lang": "en"}]
    places = {attrs["id"] for _, attrs in page.tags if "id" in attrs}
    assert {one["href"][1:] for one in page.of("a")} <= places
    assert 1_000_000 < len(run_page) < 8_000_000


def test_extremes_are_those_of_the_data() -> None:
    data = run_data().sel(wheelset="wheelset")
    for row in wheel_table(data, "").rows[:4]:
        assert len(row) == 5
    one = data.sel(side="right")
    quotient = one["lateral_force"].values / one["vertical_force"].values  # to the left is outwards on the right
    cells = dict(zip([row[0] for row in wheel_table(data, "").rows], wheel_table(data, "").rows, strict=True))
    assert float(cells["derailment quotient Y/Q, maximum [1]"][3]) == pytest.approx(quotient.max(), rel=1e-3)
    assert float(cells["samples without contact [%]"][1]) == pytest.approx(100 / 40)
    unknown = data.assign(lateral_force=np.nan * data["lateral_force"])
    assert extreme(unknown.sel(side="left"), "lateral_force", "largest") == ("–", "–")
    assert extreme(data.sel(side="right"), "lateral_force", "largest")[0] == "-20"  # kN


def test_view_shows_the_largest_lateral_force() -> None:
    data = run_data()
    assert largest_force(data) == (data.sizes["time"] - 1, "wheelset")
    force = data["lateral_force"].copy()
    force[7, 0, 0] = 9e5
    assert largest_force(data.assign(lateral_force=force)) == (7, "wheelset")


def test_without_a_view(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Omitted on request; if it cannot be drawn, the page names the reason."""

    def said(data: Dataset, **options: bool) -> str:
        write(data.isel(time=[0]), tmp_path / "run.nc")
        return Reader(write_report(tmp_path, **options).read_text(encoding="utf-8")).text

    data = run_data()
    without = said(data, view=False)
    assert "3D view" not in without
    assert "fewer than two samples" in without
    worn = said(data.assign_attrs(scene=SCENE.replace('"S1002"', '"worn.prw"')))
    assert re.search(r"No 3D view: .*worn\.prw", worn)

    def missing() -> None:
        raise ImportError("3D views need pyvista")

    monkeypatch.setattr(off_screen, "_imported", missing)
    assert "No 3D view: 3D views need pyvista." in said(data)


def test_a_comparison(tmp_path: Path) -> None:
    for name, factor in (("condensed", 1.0), ("standard", 1.01)):
        data = run_data()
        write(data.assign(vertical_force=factor * data["vertical_force"]), tmp_path / name / "run.nc")
    (tmp_path / "differences.json").write_text('{"first": "condensed", "second": "standard"}')
    outcome = CliRunner().invoke(app, ["report", str(tmp_path), "--out", str(tmp_path / "both.html"), "--no-view"])
    assert outcome.exit_code == 0, outcome.output
    page = Reader((tmp_path / "both.html").read_text(encoding="utf-8"))
    rows = {row[0]: row[1:] for row in page.rows}
    assert rows["vertical force, right"][:3] == ["kN", "0.6321", "0.72"]  # 0.01 of 54 + 18 u, u from 0 to 1: sqrt(3996)
    assert rows["contact problems solved"] == ["300", "301"] * 2
    assert len(page.of("img")) == 9
    assert "Comparison of the contact models condensed and standard" in page.text


@pytest.fixture
def study_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A study of three loads and two radii; one case of them fails."""

    def work(job: Any) -> CaseResult:
        return CaseResult("failed", "<b>too heavy</b>", 0.1) if job.table["load"] == 3e4 else solve(job)

    monkeypatch.setattr(run_module, "processes", lambda count: Here(work))
    grid = {"load": [1e4, 2e4, 3e4], "upper.radii": [[0.46, float("inf")]]}
    run_study(study(grid=grid), tmp_path, pictures=False)
    return tmp_path


def test_a_study(study_folder: Path) -> None:
    text = write_report(study_folder).read_text(encoding="utf-8")
    page = Reader(text)
    assert "Study of 3 cases, pairs of bodies" in page.text
    assert "2 converged, 1 failed" in page.text
    assert machine() in page.text
    assert ["load", "N", "load", "10000, 20000, 30000"] in page.rows
    assert ["upper.radii", "–", "upper_radii", "[0.46, inf]"] in page.rows
    assert ["30000", "[0.46, inf]", "<b>too heavy</b>"] in page.rows
    assert "<b>too" not in text
    assert len(page.of("img")) == 1
    kept = json.loads(read(study_folder / "study.nc").attrs["study"])
    assert kept["grid"]["upper.radii"] == [[0.46, float("inf")]]
    assert 'No 3D view: model = "standard" has no elastic bodies' in page.text


def test_study_of_runs_shows_the_maximum_peak_pressure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def work(job: Any) -> CaseResult:
        write(run_data(), jobs.run_data(Path(job.folder), job.key))
        return CaseResult("completed", "", 1.0, {"left": {"max_pressure": 1e9 * job.table["friction"]}})

    monkeypatch.setattr(run_module, "processes", lambda count: Here(work))
    table = {"scene": str(Path(__file__).parents[2] / "scenes" / "curve.toml"), "grid": {"friction": [0.2, 0.4, 0.3]}}
    run_study(table, tmp_path, pictures=False)
    (kept,) = (tmp_path / "cases").glob("*.nc")
    page = Reader(write_report(tmp_path).read_text(encoding="utf-8"))
    assert len([one for one in page.of("figure") if one.get("class") == "view"]) == 1
    assert "Largest lateral force, run with the largest peak pressure, friction = 0.4, at 90.0 m" in page.text
    kept.unlink()
    assert "No 3D view: " in Reader(write_report(tmp_path).read_text(encoding="utf-8")).text


def cases_data(count: int) -> Dataset:
    """Synthetic results of a study over a number of loads; a third of the cases failed, including the first."""
    planned = plan(check_study(study(grid={"load": [1e3 + i for i in range(count)]})))
    good = [{"contact": {"max_pressure": 1e6 * (1000 + i)}} for i in range(count)]
    ended = [
        CaseResult("failed", "no") if i % 3 == 0 else CaseResult("converged", "", 1.0, good[i]) for i in range(count)
    ]
    found = {(i,): one for i, one in enumerate(ended)}
    return results.dataset(planned, found)


def test_a_browser_sorts_all_cases_of_a_study(tmp_path: Path) -> None:
    write(cases_data(400), tmp_path / "study.nc")
    found, errors, _ = opened(write_report(tmp_path, view=False).read_text(encoding="utf-8"), tmp_path)
    assert errors == found["complaints"] == []
    failed, cases = found["tables"]
    assert (failed[0], cases[0]) == (134, 400)
    assert all(500 < height < 700 < whole for _, height, whole, *_ in (failed, cases))
    as_is, up, down, pressure, status = cases[3:]
    assert as_is == up == "1000-nanfailed: no"
    assert down == "1399-nanfailed: no"
    assert pressure == "100110011converged"  # the minimum information
    assert status.endswith("converged")


def test_long_tables_are_truncated(tmp_path: Path) -> None:
    write(cases_data(6010), tmp_path / "study.nc")
    page = Reader(write_report(tmp_path, view=False).read_text(encoding="utf-8"))
    assert "and 4010 more, in study.nc" in page.text
    assert "and 4 more, in study.nc" in page.text
    assert len(page.rows) == 2 + 2001 + 2001


# Invalid folders


@pytest.mark.parametrize(
    ("files", "complaint"),
    [
        ({}, f"DIR: contains no results; {ALLOWED}"),
        (None, f"DIR: folder does not exist; {ALLOWED}"),
        ({"run.nc": b"CDF\x01 and no more"}, "DIR/run.nc: not a readable NetCDF file, it may be damaged"),
        ({"run.nc": b""}, "DIR/run.nc: not a readable NetCDF file, it may be damaged"),
        ({"run.nc": "half"}, "DIR/run.nc: not a readable NetCDF file, it may be damaged"),
        ({"study.nc": "whole"}, "DIR/study.nc: contains no results of a study"),
        ({"run.nc": "other"}, "DIR/run.nc: must contain results of a run"),
        ({"differences.json": b"{"}, "DIR/differences.json: is no valid table of a comparison"),
        (
            {"differences.json": b'{"first": "standard", "second": "full"}'},
            "DIR/standard/run.nc: file does not exist",
        ),
        ({"differences.json": b'{"first": "../a", "second": "b"}'}, "DIR/differences.json: '../a': must be a contact"),
        ({"differences.json": b"[" * 100_000}, "DIR/differences.json: is no valid table of a comparison"),
    ],
)
def test_folders_without_results_are_rejected(files: dict[str, Any] | None, complaint: str, tmp_path: Path) -> None:
    folder = tmp_path / "given"
    for name, content in (files or {}).items():
        file = folder / name
        folder.mkdir()
        if isinstance(content, bytes):
            file.write_bytes(content)
            continue
        write(run_data() if content != "other" else Dataset({"a": 1.0}), file)
        if content == "half":
            file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    if files == {}:
        folder.mkdir()
    outcome = CliRunner().invoke(app, ["report", str(folder)])
    assert outcome.exit_code == 2
    assert outcome.stderr.replace(str(folder), "DIR").startswith(complaint)
    assert not (folder / "report.html").exists()


def test_report_is_written_atomically(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "run"
    write(run_data().isel(time=[0]), folder / "run.nc")
    (folder / "report.html").write_text("an older one")

    def full(self: Path, text: str, **_: Any) -> None:
        self.write_bytes(text.encode()[:100])
        raise OSError("no space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    outcome = CliRunner().invoke(app, ["report", str(folder), "--no-view"])
    assert outcome.exit_code == 1
    assert "no space left on device" in outcome.stderr
    assert (folder / "report.html").read_bytes() == b"an older one"
    assert {file.name for file in folder.iterdir()} == {"run.nc", "report.html"}
    refused = CliRunner().invoke(app, ["report", str(folder), "--out", str(tmp_path / "page.pdf")])
    assert refused.exit_code == 2
    assert "page.pdf: must end in .html" in refused.stderr


def test_formatting_of_numbers_and_dates() -> None:
    assert [seconds(v) for v in (0.123, 150.0, 7380.0)] == ["0.123 s", "150 s (2 min 30 s)", "7380 s (2 h 3 min)"]
