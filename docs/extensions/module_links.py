"""Links from names in code, as `wheelrail.contact.stress.shakedown`, to their place in the Python reference."""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.nodes import make_refnode


def link(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Replace names of documented modules and objects by links."""
    objects = app.env.get_domain("py").objects  # type: ignore[attr-defined]
    for literal in list(doctree.findall(nodes.literal)):
        name = literal.astext()
        if not name.startswith("wheelrail.") or name not in objects or isinstance(literal.parent, nodes.reference):
            continue
        entry = objects[name]
        literal.replace_self(make_refnode(app.builder, page, entry.docname, entry.node_id, literal.deepcopy()))


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("doctree-resolved", link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
