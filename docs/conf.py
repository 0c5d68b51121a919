"""The documentation site: Sphinx with MyST, built without a network and without writing into the sources."""

from __future__ import annotations

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

extensions = ["myst_nb", "sphinx.ext.autodoc", "extensions.mathml", "extensions.generated", "extensions.docstrings"]
exclude_patterns = ["conf.py", "extensions", "_static", "**/__pycache__", "**/.ipynb_checkpoints"]
source_suffix = {".rst": "restructuredtext", ".md": "myst-nb", ".py": "myst-nb"}
suppress_warnings = ["config.cache", "ref.python"]  # a name may be public in two places

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "off"  # the tests execute them

smartquotes = False  # "--resume" is no dash

html_theme = "furo"
html_title = f"wheelrail {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False

autodoc_member_order = "bysource"
autodoc_type_aliases = {name: name for name in ("Array", "Nodes", "Mask", "Law", "RailShift", "Contact")}
python_use_unqualified_type_names = True
python_display_short_literal_types = True
