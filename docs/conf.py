"""The documentation site: Sphinx with MyST, built without a network and without writing into the sources."""

from __future__ import annotations

import os
import sys
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path[:0] = [str(ROOT), str(HERE)]

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

project = PROJECT["name"]
author = "The wheelrail developers"
copyright = f"{author}, {PROJECT['license']['text']}"
release = version = PROJECT["version"]

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "extensions.mathml",
    "extensions.generated",
    "extensions.docstrings",
    "extensions.module_links",
    "extensions.numbered_equations",
]
exclude_patterns = ["conf.py", "extensions", "_static", "**/__pycache__", "**/.ipynb_checkpoints", "**/*.ipynb"]
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".py": "myst-nb"}
suppress_warnings = ["config.cache", "ref.python"]  # a name may be public in two places

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
# `make docs` executes the notebooks, which are then kept until their text changes; tests of the site leave that to the
# tests of the notebooks.
nb_execution_mode = os.environ.get("DOCS_NOTEBOOKS", "off")
nb_execution_cache_path = str(ROOT / "build/notebooks")
nb_execution_timeout = 900  # s
nb_execution_raise_on_error = True
nb_merge_streams = True

smartquotes = False  # "--resume" is no dash

html_theme = "furo"
html_title = f"wheelrail {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False

autodoc_member_order = "bysource"
autodoc_type_aliases = {name: name for name in ("Array", "Nodes", "Mask", "Law", "RailShift", "Contact", "ArrayBySide")}
python_use_unqualified_type_names = True
python_display_short_literal_types = True
