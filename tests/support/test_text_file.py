"""Files from outside: regular ones of a bounded size, read without waiting; JSON of bounded depth."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.support.text_file import FileRefused, json_value, read_bytes, read_text


def test_content_up_to_the_bound_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"x" * 1000)
    assert read_bytes(tmp_path / "file", 1e-3, "a file") == b"x" * 1000
    (tmp_path / "file").write_bytes(b"x" * 1001)
    with pytest.raises(FileRefused, match=r"allowed: a file of at most 0\.001 MB"):
        read_bytes(tmp_path / "file", 1e-3, "a file")


@pytest.mark.parametrize("place", ["/dev/zero", "/proc/self/pagemap", "/proc/kmsg", "nul\0character", "n" * 5000])
def test_files_without_an_end_are_refused_at_once(place: str) -> None:
    """Of the system; /proc/kmsg waits for messages, for root."""
    with pytest.raises(FileRefused, match="cannot be read"):
        read_bytes(place, 1.0, "a file")


@pytest.mark.parametrize(
    "command", [["contact"], ["run"], ["study"], ["track"], ["table"], ["export", "--fmu", "a.fmu"]]
)
def test_a_pipe_as_scene_is_one_line(command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    os.mkfifo("pipe.toml")
    done = CliRunner().invoke(app, [*command, "pipe.toml"])
    assert done.exit_code == 2
    assert done.stderr == "pipe.toml: cannot be read: a pipe; allowed: a text file of at most 1 MB\n"


def test_a_pipe_in_place_of_the_table_of_a_comparison(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "differences.json")
    done = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert done.exit_code == 2
    assert "differences.json: cannot be read: a pipe" in done.stderr


@pytest.mark.parametrize("text", ["[" * 100_000, "[" * 40 + "]" * 40, '{"a":' * 40 + "1" + "}" * 40])
def test_json_in_many_levels_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="levels deep"):
        json_value(text)
    assert json_value('{"a": [1, {"b": null}]}') == {"a": [1, {"b": None}]}


def test_text_in_utf_16_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes("kind".encode("utf-16"))
    with pytest.raises(FileRefused, match="UTF-16"):
        read_text(tmp_path / "file", 1.0)


def test_tables_are_printed_in_a_locale_of_ascii() -> None:
    """Headings like "gradient per mille" have characters that ASCII has not."""
    root = Path(__file__).parents[2]
    environment = {
        **os.environ,
        "LC_ALL": "C",
        "PYTHONUTF8": "0",
        "PYTHONCOERCECLOCALE": "0",
        "PYTHONPATH": str(root),
    }
    line = [sys.executable, "-m", "wheelrail.cli", "track", str(root / "scenes" / "irregular.toml")]
    done = subprocess.run(line, capture_output=True, text=True, env=environment, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "gradient [\\u2030]" in done.stdout


@pytest.mark.parametrize("host", ["a" * 64, "a..b", ".", "h" * 300])
def test_a_host_that_cannot_be_one_is_one_line(host: str, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text('kind = "study"\nscene = "scene.toml"\n[grid]\nfriction = [0.3]\n')
    (tmp_path / "scene.toml").write_text((Path(__file__).parents[2] / "scenes" / "hertz.toml").read_text())
    line = ["study", str(tmp_path / "study.toml"), "--out", str(tmp_path), "--scheduler", f"tcp://{host}:8786"]
    done = CliRunner().invoke(app, line)
    assert done.exit_code == 2
    assert "is not a known host" in done.stderr


@pytest.mark.parametrize("length", ["5e-324", "1e-300", "1e-160", "1e-9"])
def test_ramps_of_no_length_are_one_line(length: str, tmp_path: Path) -> None:
    scenes = Path(__file__).parents[2] / "scenes"
    irregular, curve = ((scenes / name).read_text() for name in ("irregular.toml", "curve.toml"))
    fade = irregular.replace("fade = 10.0", f"fade = {length}")
    ramp = curve.replace("transition_length = 100.0", f"transition_length = {length}")
    speed = curve.replace("speed = 45.0", f"speed = [[0.0, 45.0], [{length}, 40.0]]")
    for text, key in ((fade, "track.irregularities.fade = "), (ramp, "track"), (speed, "vehicle.speed = ")):
        (tmp_path / "scene.toml").write_text(text)
        done = CliRunner().invoke(app, ["track", str(tmp_path / "scene.toml")])
        assert done.exit_code == 2
        assert done.stderr.startswith(f"{tmp_path}/scene.toml: {key}")
