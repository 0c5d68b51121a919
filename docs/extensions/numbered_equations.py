"""Numbers of all displayed equations of the theory, page by page."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

FOLDER = "theory/"


def number(app: Sphinx, doctree: nodes.document) -> None:
    """Give every displayed equation of a page without a label a number."""
    page, domain = app.env.docname, app.env.get_domain("math")
    if not page.startswith(FOLDER):
        return
    unnumbered = [node for node in doctree.findall(nodes.math_block) if not node.get("number")]
    for index, node in enumerate(unnumbered):
        label = f"{page}:{index}"
        domain.note_equation(page, label, location=node)  # type: ignore[attr-defined]
        node["number"] = domain.get_equation_number_for(label)  # type: ignore[attr-defined]
        node["label"], node["docname"] = label, page


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("doctree-read", number)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
