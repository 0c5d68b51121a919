"""Page of a run: the vehicle on its track, the patches of every wheel, forces with one cursor, jumps to maxima."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

from wheelrail.explorer import jobs
from wheelrail.explorer.engine import Latest, Worker
from wheelrail.explorer.layout import STYLE, drop, html, notice, pictures, select, trame, ui, v
from wheelrail.explorer.run_views import CURVES, FIRST_CURVES, Curves, largest, patch_panels
from wheelrail.explorer.views import as_text
from wheelrail.scenes.datasets.run_file import read_run
from wheelrail.scenes.quantities import RUN

FRAMES = 20  # per second, while it plays
MOVED = ("sample", "wheelset", "view_patches", "view_vehicle", *(f"view_{name}" for name in CURVES))


class Player:
    """The page of one run.

    Parameters:
        server: of trame.
        file: results of the run.

    Raises SceneError for a file without results of a run, OSError.
    """

    def __init__(self, server: Any, file: Path) -> None:
        self.state, self.server, self.file = server.state, server, file
        self.data = read_run(file)
        self.names = [name for name in CURVES if name in self.data]
        self.painter = Worker(lambda _: None)
        self.numbers, self.vehicle = Latest(self._draw, self._nothing), Latest(self._paint, self._nothing)
        self._playing: asyncio.Task[None] | None = None
        self.state.update(
            {
                **{f"view_{name}": name in FIRST_CURVES for name in self.names},
                **{
                    "view_patches": True,
                    "view_vehicle": True,
                    "sample": 0,
                    "wheelset": 0,
                    "jump_to": next(iter(self.names), ""),
                },
                **{
                    "curves": "",
                    "patches": "",
                    "picture": "",
                    "place": "",
                    "notice": "",
                    "dark": False,
                    "playing": False,
                },
                **{"stale": False, "reason": "", "drawn": 0, "painted": -1, "trame__title": f"{file.name}: explore"},
            }
        )
        self._layout()
        self.state.change(*MOVED)(self._moved)
        server.controller.on_server_ready.add(lambda **_: self._moved())

    def jump(self) -> None:
        """Move to the largest absolute value of the chosen quantity."""
        try:
            self.state.sample, self.state.wheelset = largest(self.data, self.state.jump_to)
        except (KeyError, ValueError) as error:
            self.state.notice = str(error)

    def play(self) -> None:
        """Play the run from the present sample, or stop."""
        if self._playing is not None and not self._playing.done():
            self._playing.cancel()
            self.state.playing = False
            return
        self.state.playing = True
        self._playing = asyncio.get_running_loop().create_task(self._play())

    def close(self) -> None:
        """End the process that draws the vehicle."""
        self.painter.stop()

    async def _play(self) -> None:
        time = self.data["time"].values
        last, clock = len(time) - 1, asyncio.get_running_loop()
        first = 0 if self.state.sample >= last else self.state.sample
        start = clock.time()
        sample = first
        while sample < last:
            sample = int(min(last, time.searchsorted(time[first] + clock.time() - start)))
            with self.state:
                self.state.sample = sample
            await asyncio.sleep(1.0 / FRAMES)
        with self.state:
            self.state.playing = False

    def _moved(self, **_: Any) -> None:
        self.numbers.ask()
        if self.state.view_vehicle:
            self.vehicle.ask()

    async def _draw(self) -> None:
        """Curves and patches at the present sample."""
        sample = int(self.state.sample)
        names = tuple(name for name in self.names if self.state[f"view_{name}"])
        curves = Curves(self.data, names, int(self.state.wheelset)).panels(sample)
        patches = patch_panels(self.data, sample) if self.state.view_patches else []
        now = self.data.isel(time=sample)
        place = ", ".join(f"{RUN[name].texts([float(now[name])])} {RUN[name].unit}" for name in ("time", "distance"))
        with self.state:
            self.state.update(
                {
                    "curves": as_text(curves),
                    "patches": as_text(patches),
                    "place": place,
                    "drawn": sample,
                }
            )
        await asyncio.sleep(0.0)

    async def _paint(self) -> None:
        """The vehicle at the present sample, drawn by another process."""
        sample = int(self.state.sample)
        try:
            picture = await self.painter.run(jobs.frame, str(self.file), float(self.data["time"].values[sample]))
            update = {"picture": picture, "painted": sample}
        except Exception as error:
            update = {"notice": f"no picture of the vehicle: {error}", "view_vehicle": False}
        with self.state:
            self.state.update(update)

    async def _nothing(self) -> bool:
        return False

    def _layout(self) -> None:
        wheelsets = [{"title": str(name), "value": k} for k, name in enumerate(self.data["wheelset"].values)]
        quantities = [{"title": RUN[name].title, "value": name} for name in self.names]
        with ui.VAppLayout(self.server, theme=("dark ? 'dark' : 'light'",)) as layout:
            trame.Style(STYLE)
            with v.VAppBar(density="compact"):
                v.VBtn("{{ playing ? 'stop' : 'play' }}", click=self.play, size="small", classes="wr-play")
                v.VSlider(
                    v_model=("sample",),
                    min=0,
                    max=self.data.sizes["time"] - 1,
                    step=1,
                    hide_details=True,
                    classes="mx-4",
                )
                html.Span("{{ place }}", classes="wr-status text-body-2 mr-3")
                for name, items, label in (("jump_to", quantities, "largest"), ("wheelset", wheelsets, "wheelset")):
                    select(name, items, label, style="max-width: 220px")
                v.VBtn("jump", click=self.jump, size="small", classes="wr-jump")
                v.VBtn("{{ dark ? 'light' : 'dark' }}", click="dark = !dark", size="small")
                drop(v_show="false", dark="dark = $event")
            with v.VMain():
                notice()
                with html.Div(classes="wr-row px-2"):
                    for name, text in (
                        ("vehicle", "vehicle"),
                        ("patches", "patches"),
                        *((name, RUN[name].title) for name in self.names),
                    ):
                        v.VCheckbox(v_model=(f"view_{name}",), label=text, density="compact", hide_details=True)
                with html.Div(classes="wr-views"):
                    with html.Div(v_if="view_vehicle && picture", classes="wr-view wr-vehicle"):
                        html.Img(src=("picture",), style="width: 100%", alt="vehicle on its track")
                    pictures("curves")
                    pictures("patches")
        layout.flush_content()
