"""Equations as MathML: browsers draw it themselves, so pages need no network, no script and no LaTeX.

Docutils, which Sphinx stands on, translates; an equation that it does not understand is a warning of the build.
"""

from __future__ import annotations

import re
from html import escape
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging

LOOSE = re.compile(r"\\[dt]?frac\s*\d{2}")  # taken for one number
BARE = re.compile(r"\\(boldsymbol|d?dot|hat|bar)\s*\\")  # takes more than the symbol behind it
BAR = re.compile(r'<mo(?: class="mathopen")?>\|</mo>')

log = logging.getLogger(__name__)


def translated(node: nodes.Element, *, block: bool) -> str:
    """MathML of a node, or its LaTeX as code after a warning."""
    tex = node.astext()
    try:
        if LOOSE.search(tex):
            raise MathError("write \\frac{1}{2}, not \\frac12")
        if BARE.search(tex):
            raise MathError("write \\dot{\\omega}, not \\dot\\omega")
        return BAR.sub('<mo lspace="0" rspace="0" stretchy="false">|</mo>', tex2mathml(tex, as_block=block))
    except (MathError, IndexError) as error:  # docutils trips over a script without a base
        log.warning("equation not understood: %s: %s", error, tex, location=node)
        return f"<code>{escape(tex)}</code>"


def inline(writer: Any, node: nodes.Element) -> None:
    writer.body.append(translated(node, block=False))
    raise nodes.SkipNode


def block(writer: Any, node: nodes.Element) -> None:
    writer.body.append(writer.starttag(node, "div", CLASS="equation"))
    if node.get("number"):
        writer.body.append(f'<span class="eqno">({node["number"]})</span>')
    writer.body.append(translated(node, block=True) + "</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
