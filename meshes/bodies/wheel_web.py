"""Dimensions of a monobloc wheel below its rim: web, hub, bore and the fillets between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array

FILLED = 0.9  # of the height of a web, at most, by both fillets
CHORD_ERROR = 5e-4  # m, of a fillet's polyline: 0.2 rad and 10 mm an edge on 45 mm, no finer than the mesh there


@dataclass(frozen=True)
class WheelShape:
    """Section of a monobloc wheel in (y, r), y to the field side, m.

    Defaults: a wagon wheel of 920 mm. The width of the rim is that of EN 13715 and UIC 510-2 (135 mm, the flange's back
    70 mm from the rolling circle), the bore that of a seat of 185 mm (EN 13103-1); thicknesses, fillets and the hub are
    typical of forged wheels to EN 13262, not those of one drawing.
    Parameters:
        rim_thickness: m.
        faces: y of back and front of the rim, m.
        web: thickness at rim and hub, m.
        web_middle: y of the middle of the web at rim and hub, m.
        fillets: radii at rim and hub, m; of a web lower than both, as large as fit.
        hub_ends: y of the hub's ends, m.
        hub_radius, bore_radius: m.

    Raises ValueError for inconsistent values.
    """

    rim_thickness: float = 0.065
    faces: tuple[float, float] = (-0.070, 0.065)
    web: tuple[float, float] = (0.025, 0.030)
    web_middle: tuple[float, float] = (0.0, -0.010)
    fillets: tuple[float, float] = (0.035, 0.045)
    hub_ends: tuple[float, float] = (-0.100, 0.080)
    hub_radius: float = 0.135
    bore_radius: float = 0.0925

    def __post_init__(self) -> None:
        lengths = (self.rim_thickness, self.bore_radius, *self.web, *self.fillets)
        if not min(lengths) > 0.0:
            raise ValueError(f"thicknesses and radii of a wheel must be positive, not {lengths} m")
        if not self.bore_radius < self.hub_radius:
            raise ValueError(f"a bore of {self.bore_radius} m does not fit into a hub of {self.hub_radius} m")
        for name, (low, high), middle, thickness in zip(
            ("rim", "hub"), (self.faces, self.hub_ends), self.web_middle, self.web, strict=True
        ):
            if not low < middle - 0.5 * thickness < middle + 0.5 * thickness < high:
                raise ValueError(
                    f"the web ({thickness} m at {middle} m) does not fit between {name} ends {low}, {high}"
                )

    def below_the_rim(self, radius: float, front: float, back: float) -> Array:
        """Polyline (m, 2) m from the lower front corner of the rim around the bore to its lower back corner.

        Parameters:
            radius: nominal rolling radius, m.
            front, back: y of the faces of the rim, m.

        Raises ValueError for a hub that does not fit.
        """
        inner = radius - self.rim_thickness
        if not self.hub_radius < inner:
            raise ValueError(f"a hub of {self.hub_radius} m does not fit into a rim of {inner:g} m")

        def side(sign: float) -> list[tuple[float, float]]:
            (rim, hub), (top, bottom) = self.web_middle, self.web
            return [(rim + 0.5 * sign * top, inner), (hub + 0.5 * sign * bottom, self.hub_radius)]

        low, high = self.hub_ends
        bore = [(high, self.hub_radius), (high, self.bore_radius), (low, self.bore_radius), (low, self.hub_radius)]
        corners = np.array([(front, inner), *side(1.0), *bore, *side(-1.0)[::-1], (back, inner)])
        rounding = np.zeros(len(corners))
        fillets = np.array(self.fillets) * min(1.0, FILLED * (inner - self.hub_radius) / sum(self.fillets))
        rounding[[1, 2, -3, -2]] = (*fillets, *fillets[::-1])
        return rounded(corners, rounding)


def rounded(corners: Array, radii: Array, *, chord_error: float = CHORD_ERROR) -> Array:
    """Polyline through corners (n, 2) m, rounded by chords of arcs tangent to both sides.

    Parameters:
        corners: (n, 2) m; both ends are kept.
        radii: (n,) m, 0 for a sharp corner.
        chord_error: largest distance of a chord from its arc, m.

    Raises ValueError for arcs longer than the sides between them.
    """
    edges = np.diff(corners, axis=0)
    length = np.hypot(*edges.T)
    along = edges / length[:, None]
    turn = np.zeros(len(corners))
    turn[1:-1] = np.arctan2(
        along[:-1, 0] * along[1:, 1] - along[:-1, 1] * along[1:, 0], (along[:-1] * along[1:]).sum(axis=1)
    )
    tangent = radii * np.tan(0.5 * np.abs(turn))
    if (tangent[:-1] + tangent[1:] >= length).any():
        raise ValueError(f"fillets of {radii.max():g} m do not fit between corners {length.min():g} m apart")
    out: list[Array] = []
    for i, (corner, radius) in enumerate(zip(corners, radii, strict=True)):
        if radius == 0.0:
            out.append(corner)
            continue
        sense = np.sign(turn[i])
        inward = sense * np.array([-along[i - 1, 1], along[i - 1, 0]])
        centre = corner - tangent[i] * along[i - 1] + radius * inward
        # sagitta R (1 - cos(step / 2))
        count = max(2, int(np.ceil(abs(turn[i]) / (2 * np.arccos(1 - min(chord_error / radius, 0.1))))))
        angle = turn[i] * np.arange(count + 1) / count
        c, s = np.cos(angle), np.sin(angle)
        x, y = -radius * inward
        out.extend(centre + np.column_stack([c * x - s * y, s * x + c * y]))
    return np.array(out)
