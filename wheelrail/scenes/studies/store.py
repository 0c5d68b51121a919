"""Finished cases, a file each as soon as it is done: what is there is whole, or is not read."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from wheelrail.scenes.studies.job import run_data, unfinished
from wheelrail.scenes.studies.solve import Found
from wheelrail.support.atomic_file import whole_file


@dataclass(frozen=True)
class Store:
    """A folder of cases by the key of their job."""

    folder: Path

    def load(self, key: str) -> Found | None:
        """None for a case that is not there, or whose file is damaged or of another version: it is computed anew."""
        try:
            seal, text = self._file(key).read_text(encoding="utf-8").split("\n", 1)
            if seal != _seal(key, text):
                return None
            return Found(**json.loads(text))
        except (OSError, ValueError, TypeError):
            return None

    def keep(self, key: str, found: Found) -> None:
        """On disk when this returns, in one stroke; checkpoints go then. Raises OSError."""
        text = found.text()
        with whole_file(self._file(key)) as part, part.open("w", encoding="utf-8") as stream:
            stream.write(f"{_seal(key, text)}\n{text}")
            stream.flush()
            os.fsync(stream.fileno())
        unfinished(self.folder, key).unlink(missing_ok=True)

    def forget(self, key: str) -> None:
        for file in (self._file(key), unfinished(self.folder, key), run_data(self.folder, key)):
            file.unlink(missing_ok=True)

    def hardest_run(self, known: Mapping[str, Found]) -> str | None:
        """The run with the largest peak pressure of those whose data are there, failed ones last; the others' go."""
        keys = [path.stem for path in self.folder.glob("*.nc") if path.stem in known]
        keys.sort(key=lambda key: (known[key].ok, known[key].peak_pressure, key))
        for key in keys[:-1]:
            run_data(self.folder, key).unlink(missing_ok=True)
        return keys[-1] if keys else None

    def _file(self, key: str) -> Path:
        return self.folder / f"{key}.json"


def _seal(key: str, text: str) -> str:
    """The key, too: a file under another name is another case's."""
    return hashlib.sha256(f"{key}\n{text}".encode()).hexdigest()
