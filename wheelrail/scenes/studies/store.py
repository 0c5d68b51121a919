"""Results of finished cases, one file per case, written atomically and read only with a correct checksum.

sqlite3 is not used, by measurement (SQLite 3.40, ext4, 400 cases of 1.6 kB). It needs the same checksums: for 300 of
500 files with one bit flipped it returned changed text, and integrity_check passed. It lost all cases of 99 of 100
truncated files; here damage costs one case. A case takes 19 ms with a rollback journal, 4 ms with WAL and 4 ms here.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from wheelrail.scenes.studies.job import run_data, unfinished
from wheelrail.scenes.studies.solve import CaseResult
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.text_file import json_value, read_text

MOST = 1000.0  # MB


@dataclass(frozen=True)
class Store:
    """A folder of results by the key of the case's job."""

    folder: Path

    def load(self, key: str) -> CaseResult | None:
        """The result of a case; None if it is missing, damaged or of another version, so that it is computed again."""
        try:
            checksum, text = read_text(self._file(key), MOST).split("\n", 1)
            if checksum != _checksum(key, text):
                return None
            return CaseResult(**json_value(text))
        except (ValueError, TypeError):
            return None

    def save(self, key: str, result: CaseResult) -> None:
        """Write a result atomically, on disk when this returns, and remove the case's checkpoints. Raises OSError."""
        text = result.text()
        with atomic_file(self._file(key)) as part, part.open("w", encoding="utf-8") as stream:
            stream.write(f"{_checksum(key, text)}\n{text}")
            stream.flush()
            os.fsync(stream.fileno())
        unfinished(self.folder, key).unlink(missing_ok=True)

    def remove(self, key: str) -> None:
        """Remove result, checkpoints and data of a case."""
        for file in (self._file(key), unfinished(self.folder, key), run_data(self.folder, key)):
            file.unlink(missing_ok=True)

    def prune_run_data(self, results: Mapping[str, CaseResult]) -> str | None:
        """Key of the run with the maximum peak pressure among runs with data on disk; removes all other data.

        Parameters:
            results: by key.

        A failed run is chosen only if no other has data.
        """
        keys = [path.stem for path in self.folder.glob("*.nc") if path.stem in results]
        keys.sort(key=lambda key: (results[key].ok, results[key].peak_pressure, key))
        for key in keys[:-1]:
            run_data(self.folder, key).unlink(missing_ok=True)
        return keys[-1] if keys else None

    def _file(self, key: str) -> Path:
        return self.folder / f"{key}.json"


def _checksum(key: str, text: str) -> str:
    """SHA-256 of key and text, so that a renamed file does not pass for another case."""
    return hashlib.sha256(f"{key}\n{text}".encode()).hexdigest()
