"""Layout of the page: controls in a drawer, views side by side, and texts to copy."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING, Any, Protocol

from trame_client.widgets import html
from trame_client.widgets.core import AbstractElement
from trame_client.widgets.trame import Style
from trame_vuetify.ui.vuetify3 import VAppLayout
from trame_vuetify.widgets import vuetify3 as v

from wheelrail.explorer.subject import CHOSEN
from wheelrail.explorer.views import BESIDE, DRAWN, TRACED

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from wheelrail.explorer.controls import Control
    from wheelrail.explorer.subject import Subject

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
.wr-stale { opacity: 0.45; }
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


class Drop(AbstractElement):  # type: ignore[misc]
    """Target of files that are dropped on the page, its theme and keys, see `browser/page.js`."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("wr-drop", **kwargs)
        self._attr_names += ["largest", "picks"]
        self._event_names += ["file", "dark", "reset"]


class Pictures(AbstractElement):  # type: ignore[misc]
    """Pictures of the panels in a variable of the state, see `browser/page.js`, greyed while another one is true."""

    def __init__(self, name: str, stale: str = "stale", **kwargs: Any) -> None:
        picks = ("true" if "pick" in kwargs else "false",)
        super().__init__("wr-pictures", name=name, stale=stale, picks=picks, **kwargs)
        self._attr_names += ["name", "stale", "picks"]
        self._event_names += ["pick"]


class Slider(AbstractElement):  # type: ignore[misc]
    """Slider and field of a control, see `browser/page.js`; of a given variable shown while that has a value."""

    def __init__(self, control: Control, variable: str, value: str) -> None:
        low, high, step = (repr(float(own)) for own in (control.low, control.high, control.step))
        super().__init__(
            "wr-slider",
            name=control.name,
            label=control.label,
            unit=control.unit or "1",
            low=(low,),
            high=(high,),
            step=(step,),
            text=(str(control.text).lower(),),
            variable=variable,
            value=value,
        )
        self._attr_names += ["name", "label", "unit", "low", "high", "step", "text", "variable", "value"]


class Follower(AbstractElement):  # type: ignore[misc]
    """A component of `browser/page.js` without arguments."""


def draw_layout(page: Page) -> None:
    """Build the page."""
    with VAppLayout(page.server, theme=("dark ? 'dark' : 'light'",)) as layout:
        Style(STYLE)
        with v.VAppBar(density="compact"):
            v.VAppBarNavIcon(click="drawer = !drawer", aria_label="controls")
            Follower("wr-status")
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
                    Drop(file=(page.drop, "[$event]"), dark="dark = $event", reset=page.reset, picks=("true",))
            if page.subject.kind != "wheelset":
                Drop(v_show="false", dark="dark = $event", reset=page.reset)
            html.Div("views", classes="text-subtitle-2 px-3 pt-3")
            for name, text in {**DRAWN, **BESIDE}.items():
                if page.has_view(name):
                    v.VCheckbox(
                        v_model=(f"view_{name}",), label=text, density="compact", hide_details=True, classes="px-2"
                    )
        with v.VMain():
            notice()
            with html.Div(classes="wr-views"):
                Pictures("panels")
                if page.has_view("geometry"):
                    Pictures("surveyed", v_show="view_geometry", pick=(page.survey, "[$event]"))
                _trace(page)
                _requested(page)
            with html.Div(classes="px-2 wr-table"):
                Follower("wr-table")
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
        Slider(control, *given)
        return
    items = (f"choices_{control.key}",) if control.key in ("wheel", "rail") else (repr(list(control.choices)),)
    with html.Div(classes="wr-control"):
        v.VSelect(
            v_model=(control.name,),
            items=items,
            label=control.label,
            density="compact",
            hide_details=True,
            variant="underlined",
        )


def _alternatives(page: Page) -> None:
    labels = {own.key: own.label for own in page.subject.controls_of_kind if own.key in page.subject.alternatives}
    items = [{"title": text, "value": key} for key, text in labels.items()]
    with html.Div(classes="wr-control"):
        v.VSelect(
            v_model=(CHOSEN,),
            items=(repr(items),),
            label="given",
            density="compact",
            hide_details=True,
            variant="underlined",
        )


def _trace(page: Page) -> None:
    """Choice of slider and quantity, and the trace."""
    sliders = [
        {"title": own.label, "value": own.key} for own in page.subject.controls if own.choices is None and not own.text
    ]
    quantities = [{"title": own.title, "value": name} for name, (own, _) in TRACED.items()]
    with html.Div(v_if="view_trace", classes="wr-view wr-trace"):
        with html.Div(classes="wr-row"):
            for name, items, label in (("trace_of", quantities, "quantity"), ("trace_key", sliders, "along")):
                v.VSelect(
                    v_model=(name,),
                    items=(repr(items),),
                    label=label,
                    density="compact",
                    hide_details=True,
                    variant="underlined",
                )
        Pictures("tracing", pick=(page.follow, "[$event]"))


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
                Pictures(name, stale="requested_stale")
            else:
                with html.Div(v_for=f"(view, index) in {name}", key="index"):
                    html.Div("{{ view[0] }}", classes="text-caption")
                    html.Iframe(srcdoc=("view[1]",), raw_attrs=['sandbox="allow-scripts"'])
