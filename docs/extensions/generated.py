"""Pages, or parts of them, that the code itself writes at every build: a line "generated: NAME" stands for them.

In Markdown "% generated: NAME", in reStructuredText ".. generated: NAME". Nothing is written to disk.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import Any

from sphinx.application import Sphinx

from extensions.benchmark_list import benchmark_list
from extensions.commands import commands
from extensions.element_variables import element_variables
from extensions.public_names import TOPICS, public_names
from extensions.run_variables import run_variables
from extensions.scene_keys import scene_keys, study_keys, wear_keys
from extensions.wagon_values import wagon_values

PARTS: dict[str, Callable[[], str]] = {
    "benchmark-list": benchmark_list,
    "commands": commands,
    "element-variables": element_variables,
    **{f"public-names-{topic}": partial(public_names, topic) for topic in TOPICS},
    "run-variables": run_variables,
    "scene-keys": scene_keys,
    "study-keys": study_keys,
    "wear-keys": wear_keys,
    "wagon-values": wagon_values,
}
LINE = re.compile(r"^(?:%|\.\.) generated: ([\w-]+)$", re.MULTILINE)


def filled(text: str) -> str:
    """The text with every such line replaced by what it stands for. Raises KeyError for names that are not known."""
    return LINE.sub(lambda match: PARTS[match[1]](), text)


def read(app: Sphinx, page: str, source: list[str]) -> None:
    source[0] = filled(source[0])


def outdated(app: Sphinx, env: Any, added: set[str], changed: set[str], removed: set[str]) -> list[str]:
    """Pages that hang on the code are read again in every build."""
    return [page for page in env.found_docs if LINE.search(env.doc2path(page).read_text(encoding="utf-8"))]


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", read)
    app.connect("env-get-outdated", outdated)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
