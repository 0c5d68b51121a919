"""Two bodies with given principal radii: Hertz's contact, and rolling or shifting friction in it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from wheelrail.api.arguments import keys_of, known, plain, replaced, scene_of
from wheelrail.api.solution import Solution, solved
from wheelrail.scenes.builders.hertz import hertz_model
from wheelrail.scenes.contacts.solve import solve_sides
from wheelrail.scenes.schema.scene import HertzScene
from wheelrail.scenes.schema.tables import BodyTable

if TYPE_CHECKING:
    from wheelrail.contact.analytical.hertz import Hertz as ClosedForm
    from wheelrail.contact.models.wheelset import ContactModel

GROUPS = (("load", "approach"), ("creepage", "shift"), ("speed", "shift"))
KEPT = 8  # models for different loads


class Hertz:
    """Two elastic bodies with given principal radii that touch in one point, upper on lower.

    upper, lower: principal radii (in x, in y) in m, inf is straight and negative is hollow; or a dict with radii, E and
    nu. friction: coefficient, 0 skips all tangential work. E: Young's modulus Pa and nu: Poisson's ratio of both.
    surface_size m: edge of the surface cells; cells fitted to the patch (the default) do not depend on it. Further
    arguments are the keys of a Hertz scene: model ("condensed", "full", "standard"), laws ("exact", "paper"), bodies,
    points, strips, cells, degree, falling, ...; and those of `solve`, which then are its defaults.

    Bodies are meshed for a load when it is first asked for, and kept. Raises SceneError, a ValueError, naming the
    argument, its value and what is allowed.
    """

    def __init__(
        self,
        upper: Sequence[float] | Mapping[str, Any] = (0.46, float("inf")),
        lower: Sequence[float] | Mapping[str, Any] = (float("inf"), 0.30),
        *,
        friction: float = 0.3,
        E: float = 2.1e11,
        nu: float = 0.3,
        surface_size: float | None = None,
        **more: Any,
    ) -> None:
        known("Hertz", more, (key for key in keys_of(HertzScene) if key != "kind"))
        if surface_size is None and more.get("model") != "standard":
            surface_size = 1e-3
        bodies = {"upper": _body(upper, E, nu), "lower": _body(lower, E, nu)}
        self.arguments: dict[str, Any] = {**bodies, "friction": friction, "surface_size": surface_size, **more}
        self._models: OrderedDict[tuple[Any, ...], ContactModel] = OrderedDict()
        self._scene({} if {"load", "approach"} & more.keys() else {"load": 1e4})

    def solve(
        self,
        *,
        load: float | None = None,
        approach: float | None = None,
        speed: float | None = None,
        creepage: Sequence[float] | None = None,
        shift: Sequence[float] | None = None,
        error_estimate: bool | None = None,
        stress: Mapping[str, Any] | None = None,
    ) -> Solution:
        """The contact under a load N or at an approach m, one of the two.

        With friction the bodies roll at a speed m/s (10 unless given; forces depend on it only where friction falls)
        with a creepage (longitudinal, lateral, spin in rad/m), upper minus lower over the speed, 0 unless given; or the
        upper one is pushed once against the lower one by a shift (x, y) m. error_estimate: solve once more on half as
        many cells. stress: {"depths": [...] m, "body": "upper", "lower" or "both"} below the patch.

        A load that cannot be carried is a status "failed: ..." of the solution and no error. Raises SceneError.
        """
        given = {
            "load": load,
            "approach": approach,
            "speed": speed,
            "creepage": creepage,
            "shift": shift,
            "error_estimate": error_estimate,
            "stress": stress,
        }
        scene = self._scene(given)
        return solved(
            scene, dict(solve_sides(scene, model=self._model(scene))), (), replaced(self.arguments, given, GROUPS)
        )

    def closed_form(self, *, load: float | None = None, approach: float | None = None) -> ClosedForm:
        """Hertz's own answer under a load N or at an approach m: semi_axes m, peak Pa, approach m, force N.

        Johnson, Contact Mechanics, 1985, ch. 4. Raises ValueError unless one of the two is given.
        """
        from wheelrail.contact.analytical.hertz import hertz, modulus
        from wheelrail.contact.geometry.quadric_pair import curvature

        upper, lower = (BodyTable.model_validate(self.arguments[name]) for name in ("upper", "lower"))
        A, B = curvature(upper.radii) + curvature(lower.radii)
        return hertz(A, B, modulus((upper.E, upper.nu), (lower.E, lower.nu)), force=load, approach=approach)

    def _scene(self, given: Mapping[str, Any]) -> HertzScene:
        keys = replaced(self.arguments, given, GROUPS)
        if keys["friction"] != 0.0 and keys.get("shift") is None:
            keys = {"speed": 10.0, "creepage": (0.0, 0.0, 0.0), **keys}
        scene = scene_of("Hertz", "hertz", keys, {})
        assert isinstance(scene, HertzScene)
        return scene

    def _model(self, scene: HertzScene) -> ContactModel:
        """The model for the load of a scene, and for its kind of motion."""
        key = (scene.load, scene.approach, scene.shift is None)
        if key not in self._models:
            self._models[key] = hertz_model(scene)
        self._models.move_to_end(key)
        while len(self._models) > KEPT:
            self._models.popitem(last=False)
        return self._models[key]

    def __repr__(self) -> str:
        said = ", ".join(f"{key}={value!r}" for key, value in self.arguments.items() if value is not None)
        return f"Hertz({said})"


def _body(given: Sequence[float] | Mapping[str, Any], E: float, nu: float) -> Any:
    """A table of the scene."""
    if isinstance(given, Mapping):
        return {"E": E, "nu": nu, **plain(given)}
    return {"radii": plain(given), "E": E, "nu": nu}
