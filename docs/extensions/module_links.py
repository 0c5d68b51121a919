"""Links from names in code, as `wheelrail.contact.stress.shakedown`, to their place in the Python reference."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.nodes import make_refnode

BACK = re.compile(r'(class="viewcode-back" href="[^"#]*#)wheelrail\.([\w.]+)')


def link(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Replace names of documented modules and objects by links."""
    objects = app.env.get_domain("py").objects  # type: ignore[attr-defined]
    for literal in list(doctree.findall(nodes.literal)):
        name = literal.astext()
        if not name.startswith("wheelrail.") or name not in objects or isinstance(literal.parent, nodes.reference):
            continue
        entry = objects[name]
        literal.replace_self(make_refnode(app.builder, page, entry.docname, entry.node_id, literal.deepcopy()))


def link_back(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    """Links from sources to the reference: viewcode has one name of a module for all its objects, `wheelrail` for those
    of modules of which one is public there.
    """
    if not page.startswith("_modules/wheelrail"):
        return
    objects, module = app.env.get_domain("py").objects, context["title"]  # type: ignore[attr-defined]

    def target(match: re.Match[str]) -> str:
        return match[0] if f"wheelrail.{match[2]}" in objects else f"{match[1]}{module}.{match[2]}"

    context["body"] = BACK.sub(target, context["body"])


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("doctree-resolved", link)
    app.connect("html-page-context", link_back)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
