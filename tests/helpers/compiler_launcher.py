"""Launcher of compilers that takes objects of the same command beside the sources, and compiles others without
optimisation. The library for other programs, which is made for this processor alone there, is taken for any.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

BINDINGS = Path(__file__).parents[2] / "bindings"


def wording(command: list[str], sources: Path, build: Path) -> str:
    """Command of one compiler, whatever its name, without the places of sources and build."""
    text = " ".join([str(Path(command[0]).resolve()), *command[1:]])
    places = {f"{build}/CMakeFiles/": "<build>/CMakeFiles/", sys.prefix: "<environment>", str(sources.parent): "<tree>"}
    for place, name in places.items():  # the environment may lie in the tree
        text = text.replace(place, name)
    library = re.sub(r"library[-_](baseline|x86[-_]64[-_]v3)", "library", text)
    return library if library == text else library.replace(" -march=x86-64-v3", "")


def compiled() -> dict[str, Path]:
    """Objects of the build beside the sources by their commands; none if one of them is out of date."""
    ninja = [str(Path(sys.executable).with_name("ninja")), "-C", str(BINDINGS)]
    listed = subprocess.run([*ninja, "-t", "commands", "all", "library"], check=False, capture_output=True, text=True)
    lines = [line for line in listed.stdout.splitlines() if " -c " in line and " -o " in line]
    commands = [re.sub(r"^.*/ccache ", "", line).split() for line in lines]
    objects = {wording(own, BINDINGS, BINDINGS): own[own.index("-o") + 1] for own in commands}
    pending = subprocess.run([*ninja, "-n", *objects.values()], check=False, capture_output=True, text=True)
    current = bool(objects) and "no work to do" in pending.stdout
    return {name: BINDINGS / file for name, file in objects.items()} if current else {}


def listed_once(build: Path) -> dict[str, str]:
    """`compiled`, asked for by the first of all compilers in a build's folder."""
    kept = build / "compiled.json"
    if not kept.exists():
        own = kept.with_suffix(f".{os.getpid()}")
        own.write_text(json.dumps({wording: str(file) for wording, file in compiled().items()}))
        own.replace(kept)
    return dict(json.loads(kept.read_text()))


def main(sources: str, *command: str) -> int:
    made = listed_once(Path.cwd()).get(wording(list(command), Path(sources), Path.cwd()))
    if made is None:
        return subprocess.run([*command, "-O0"], check=False).returncode
    shutil.copy(made, command[command.index("-o") + 1])
    Path(command[command.index("-MF") + 1]).touch()
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
