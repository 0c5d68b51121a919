"""Layout of the page: controls in a drawer, views side by side, and texts to copy."""

from __future__ import annotations

from importlib import import_module
from itertools import groupby
from typing import TYPE_CHECKING, Any, Protocol

from wheelrail.explorer.subject import CHOSEN
from wheelrail.explorer.views import BESIDE, DRAWN, TRACED

if TYPE_CHECKING:
    from collections.abc import Awaitable, Sequence

    from wheelrail.explorer.controls import Control
    from wheelrail.explorer.subject import Subject


class Late:
    """A module of an extra, imported when a page is made."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(import_module(self.name), attribute)


core, html, trame = (Late(f"trame_client.widgets.{name}") for name in ("core", "html", "trame"))
v, ui = (Late(f"trame_vuetify.{folder}.vuetify3") for folder in ("widgets", "ui"))
STYLE = """
.v-slider *, .v-slider-thumb, .v-slider-track__fill { transition: none !important; }
.wr-views { columns: 380px; column-gap: 8px; padding: 8px; }
.wr-view { min-width: 0; break-inside: avoid; margin-bottom: 8px; }
.wr-view iframe { width: 100%; height: 420px; border: 0; }
.wr-table { font-size: 12px; overflow-x: auto; }
.wr-table td, .wr-table th { padding: 1px 8px; white-space: nowrap; text-align: left; font-weight: normal; }
.wr-table td + td, .wr-table th + th { text-align: right; font-variant-numeric: tabular-nums; }
.wr-control { padding: 0 12px; } .wr-control .v-select { padding-top: 12px; }
.wr-control .v-field__input { font-size: 13px; }
.wr-label { font-size: 12px; padding-top: 6px; }
.wr-row { display: flex; align-items: center; gap: 8px; }
.wr-row .v-slider { flex: 1; } .wr-number { width: 84px; flex: none; }
.wr-number input, .wr-text input { width: 100%; font-size: 13px; text-align: right; color: inherit;
  border: 1px solid rgba(128,128,128,0.5); border-radius: 3px; padding: 1px 4px; background: transparent; }
.wr-code { font: 12px monospace; white-space: pre-wrap; user-select: all; }
.wr-pick { font-size: 12px; padding: 4px 12px; } .wr-pick label { display: block; }
.wr-drop { position: fixed; inset: 0; z-index: 3000; display: flex; background: rgba(0, 60, 110, 0.55); }
.wr-drop > div { flex: 1; margin: 6vh 2vw; border: 3px dashed white; border-radius: 12px; color: white; font-size: 28px;
  display: flex; align-items: center; justify-content: center; }
"""


class Page(Protocol):
    """Page of a contact as its controls see one, `wheelrail.explorer.page`."""

    server: Any
    state: Any
    subject: Subject

    def reset(self) -> None: ...
    def cancel(self) -> None: ...
    def drop(self, file: dict[str, Any]) -> None: ...
    def survey(self, at: dict[str, float]) -> None: ...
    def follow(self, at: dict[str, float]) -> None: ...
    def has_view(self, name: str) -> bool: ...
    def request(self, name: str) -> Awaitable[None]: ...


def element(tag: str, attributes: Sequence[str] = (), events: Sequence[str] = (), **values: Any) -> Any:
    """A component of `browser/page.js` on the page.

    Parameters:
        tag: its name.
        attributes, events: names of its own.
        values: of both.
    """
    made = core.AbstractElement(tag, **values)
    made._attr_names += attributes
    made._event_names += events
    return made


def drop(**values: Any) -> None:
    """Target of files that are dropped on the page, its theme and keys."""
    element("wr-drop", ("largest", "picks"), ("file", "dark", "reset"), **values)


def pictures(name: str, stale: str = "stale", **values: Any) -> None:
    """Pictures of the panels in a variable of the state, greyed while another one is true."""
    picks = ("true" if "pick" in values else "false",)
    element("wr-pictures", ("name", "stale", "picks"), ("pick",), name=name, stale=stale, picks=picks, **values)


def slider(control: Control, variable: str, value: str) -> None:
    """Slider and field of a control; of a given variable shown while that has a value."""
    values: dict[str, Any] = {
        "name": control.name,
        "label": control.label,
        "unit": control.unit or "1",
        **{name: (repr(float(getattr(control, name))),) for name in ("low", "high", "step")},
        "text": (str(control.text).lower(),),
        "variable": variable,
        "value": value,
    }
    element("wr-slider", tuple(values), **values)


def draw_layout(page: Page) -> None:
    """Build the page."""
    with ui.VAppLayout(page.server, theme=("dark ? 'dark' : 'light'",)) as layout:
        trame.Style(STYLE)
        with v.VAppBar(density="compact"):
            v.VAppBarNavIcon(click="drawer = !drawer", aria_label="controls")
            element("wr-status")
            v.VProgressCircular(v_if="busy", indeterminate=True, size=18, width=2, classes="ml-2")
            v.VBtn("cancel", v_if="busy", click=page.cancel, size="small", classes="wr-cancel")
            v.VSpacer()
            v.VBtn("reset", click=page.reset, size="small", classes="wr-reset", title="key r")
            v.VBtn("copy as Python", click="shown_text = python; dialog = true", size="small", classes="wr-python")
            v.VBtn("save as scene", click="shown_text = scene; dialog = true", size="small", classes="wr-scene")
            v.VBtn("{{ dark ? 'light' : 'dark' }}", click="dark = !dark", size="small")
        with v.VNavigationDrawer(v_model=("drawer", True), width=330, mobile_breakpoint=640, scrim="false"):
            for group, controls in groupby(page.subject.controls, key=lambda control: control.group):
                html.Div(group, classes="text-subtitle-2 px-3 pt-3")
                if group == "load":
                    _alternatives(page)
                for control in controls:
                    _control(page, control)
                if group == "profiles":
                    drop(file=(page.drop, "[$event]"), dark="dark = $event", reset=page.reset, picks=("true",))
            if page.subject.kind != "wheelset":
                drop(v_show="false", dark="dark = $event", reset=page.reset)
            html.Div("views", classes="text-subtitle-2 px-3 pt-3")
            for name, text in {**DRAWN, **BESIDE}.items():
                if page.has_view(name):
                    v.VCheckbox(
                        v_model=(f"view_{name}",), label=text, density="compact", hide_details=True, classes="px-2"
                    )
        with v.VMain():
            notice()
            with html.Div(classes="wr-views"):
                pictures("panels")
                if page.has_view("geometry"):
                    pictures("surveyed", v_show="view_geometry", pick=(page.survey, "[$event]"))
                _trace(page)
                _requested(page)
            with html.Div(classes="px-2 wr-table"):
                element("wr-table")
        with v.VDialog(v_model=("dialog", False), max_width=760), v.VCard():
            with v.VCardText():
                html.Div("{{ shown_text }}", classes="wr-code")
            with v.VCardActions():
                html.A(
                    "download",
                    href=("'data:text/plain;charset=utf-8,' + encodeURIComponent(shown_text)",),
                    download=("shown_text.startsWith('import') ? 'contact.py' : 'contact.toml'",),
                    classes="wr-download",
                )
                v.VBtn("close", click="dialog = false")
    page.state.setdefault("shown_text", "")
    layout.flush_content()


def select(name: str, items: str | Sequence[Any], label: str, **more: Any) -> None:
    """Choice of a variable of the state; items: values, or the name of a variable with them."""
    known = items if isinstance(items, str) else repr(items)
    look = {"density": "compact", "hide_details": True, "variant": "underlined"}
    v.VSelect(v_model=(name,), items=(known,), label=label, **look, **more)


def notice() -> None:
    """Message of the page, until a user closes one."""
    v.VAlert(
        "{{ notice }}",
        v_if="notice",
        type="warning",
        density="compact",
        closable=True,
        click_close="notice = ''",
        classes="wr-notice",
    )


def _control(page: Page, control: Control) -> None:
    if control.choices is None:
        given = (CHOSEN, control.key) if control.key in page.subject.alternatives else ("", "")
        slider(control, *given)
        return
    items = f"choices_{control.key}" if control.key in ("wheel", "rail") else list(control.choices)
    with html.Div(classes="wr-control"):
        select(control.name, items, control.label)


def _alternatives(page: Page) -> None:
    labels = {own.key: own.label for own in page.subject.controls_of_kind if own.key in page.subject.alternatives}
    items = [{"title": text, "value": key} for key, text in labels.items()]
    with html.Div(classes="wr-control"):
        select(CHOSEN, items, "given")


def _trace(page: Page) -> None:
    """Choice of slider and quantity, and the trace."""
    sliders = [
        {"title": own.label, "value": own.key} for own in page.subject.controls if own.choices is None and not own.text
    ]
    quantities = [{"title": own.title, "value": name} for name, (own, _) in TRACED.items()]
    with html.Div(v_if="view_trace", classes="wr-view wr-trace"):
        with html.Div(classes="wr-row"):
            for name, items, label in (("trace_of", quantities, "quantity"), ("trace_key", sliders, "along")):
                select(name, items, label)
        pictures("tracing", pick=(page.follow, "[$event]"))


def _requested(page: Page) -> None:
    """Views that take seconds, each with its button."""
    for name in ("stress", "bodies"):
        with html.Div(v_if=f"view_{name}", classes=f"wr-view wr-{name}"):
            v.VBtn(
                f"compute: {BESIDE[name]}",
                click=(page.request, f"['{name}']"),
                size="small",
                disabled=("!!busy || stale",),
                classes=f"wr-request-{name}",
            )
            html.Span("not of the present place", v_if=f"requested_stale && {name}.length", classes="text-caption")
            if name == "stress":
                pictures(name, stale="requested_stale")
            else:
                with html.Div(v_for=f"(view, index) in {name}", key="index"):
                    html.Div("{{ view[0] }}", classes="text-caption")
                    html.Iframe(srcdoc=("view[1]",), raw_attrs=['sandbox="allow-scripts"'])
