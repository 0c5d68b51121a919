"""Contact of two quadratic surfaces: Hertz, Carter, Cattaneo-Mindlin and rolling with creepage."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from wheelrail.api.arguments import check_keys, keys_of, plain, replaced, scene_of
from wheelrail.api.solution import Solution, solved
from wheelrail.scenes.builders.hertz import hertz_model
from wheelrail.scenes.contacts.solve import solve_sides
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import HertzScene
from wheelrail.scenes.schema.tables import BodyTable

if TYPE_CHECKING:
    from wheelrail.api.elements.hertz_element import HertzElement
    from wheelrail.contact.analytical.hertz import Hertz as ClosedForm
    from wheelrail.contact.laws.friction import FrictionLaw
    from wheelrail.contact.models.wheelset import ContactModel

GROUPS = (("load", "approach"), ("creepage", "shift"), ("speed", "shift"))
CACHED_MODELS = 8  # for different loads


class Hertz:
    """Two elastic bodies with given principal radii in point contact.

    Parameters:
        upper, lower: principal radii (in x, in y), m, inf is straight, negative is concave; or a dict with radii, E
            and nu.
        friction: coefficient of friction, 0 skips the tangential problem; or a law of `wheelrail.contact.laws` or of
            your own.
        E: Young's modulus of both bodies, Pa.
        nu: Poisson's ratio of both bodies.
        surface_size: edge of the surface cells, m; strips and cells (the default) do not depend on it.
        more: further keys of a Hertz scene: model ("condensed", "full", "standard"), laws ("exact", "paper"), bodies,
            points, strips, cells, degree, falling, ...; and defaults for the arguments of `solve`.

    Bodies are meshed at the first solve for a load, and cached. Raises SceneError, a ValueError, naming the argument,
    its value and what is allowed.
    """

    def __init__(
        self,
        upper: Sequence[float] | Mapping[str, Any] = (0.46, float("inf")),
        lower: Sequence[float] | Mapping[str, Any] = (float("inf"), 0.30),
        *,
        friction: float | FrictionLaw = 0.3,
        E: float = 2.1e11,
        nu: float = 0.3,
        surface_size: float | None = None,
        **more: Any,
    ) -> None:
        check_keys("Hertz", more, (key for key in keys_of(HertzScene) if key != "kind"))
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
        """Solve the contact for a load or an approach, in rolling or for one tangential displacement.

        Parameters:
            load: normal load, N; or
            approach: of the bodies, m.
            speed: rolling speed, m/s, 10 by default; forces depend on it only with falling friction.
            creepage: (longitudinal, lateral, spin in 1/m), upper minus lower velocity over speed; 0 by default.
            shift: (x, y) tangential displacement of the upper body, m, instead of rolling.
            error_estimate: whether to estimate errors from two solves on half as many strips and cells.
            stress: {"depths": [...] in m, "body": "upper", "lower" or "both"}: stress below the patch.

        A load that cannot be carried gives status "failed: ..." and no exception. Raises SceneError.
        """
        arguments = {
            "load": load,
            "approach": approach,
            "speed": speed,
            "creepage": creepage,
            "shift": shift,
            "error_estimate": error_estimate,
            "stress": stress,
        }
        scene = self._scene(arguments)
        return solved(
            scene, dict(solve_sides(scene, model=self._model(scene))), None, replaced(self.arguments, arguments, GROUPS)
        )

    def element(self, *, load: float | None = None, approach: float | None = None) -> HertzElement:
        """Contact element for a time integration; bodies and tables are shared with this pair.

        Parameters:
            load: largest normal load, N, for which the compliance of the bodies is computed; or
            approach: largest approach, m.

        The speed is by default that of this pair. Raises SceneError, also for a pair with a tangential displacement.
        """
        from wheelrail.api.elements.hertz_element import HertzElement
        from wheelrail.contact.models.hertz import HertzContact

        if self.arguments.get("shift") is not None:
            raise SceneError("Hertz: shift: an element rolls; for a tangential displacement use solve")
        scene = self._scene({"load": load, "approach": approach})
        return HertzElement(HertzContact(self._model(scene)), scene.speed or 0.0)

    def closed_form(self, *, load: float | None = None, approach: float | None = None) -> ClosedForm:
        """Hertz's closed-form solution: semi_axes, m, peak, Pa, approach, m, force, N.

        Parameters:
            load: normal load, N; or
            approach: of the bodies, m.

        Johnson, Contact Mechanics, 1985, ch. 4. Raises ValueError unless one of the two is given.
        """
        from wheelrail.contact.analytical.hertz import hertz, modulus
        from wheelrail.contact.geometry.quadric_pair import curvature

        upper, lower = (BodyTable.model_validate(self.arguments[name]) for name in ("upper", "lower"))
        A, B = curvature(upper.radii) + curvature(lower.radii)
        return hertz(A, B, modulus((upper.E, upper.nu), (lower.E, lower.nu)), force=load, approach=approach)

    def _scene(self, arguments: Mapping[str, Any]) -> HertzScene:
        keys = replaced(self.arguments, arguments, GROUPS)
        if keys["friction"] != 0.0 and keys.get("shift") is None:
            keys = {"speed": 10.0, "creepage": (0.0, 0.0, 0.0), **keys}
        scene = scene_of("Hertz", "hertz", keys, {})
        assert isinstance(scene, HertzScene)
        return scene

    def _model(self, scene: HertzScene) -> ContactModel:
        """Cached contact model for load or approach, and for rolling or one tangential displacement."""
        key = (scene.load, scene.approach, scene.shift is None)
        if key not in self._models:
            self._models[key] = hertz_model(scene)
        self._models.move_to_end(key)
        while len(self._models) > CACHED_MODELS:
            self._models.popitem(last=False)
        return self._models[key]

    def __repr__(self) -> str:
        arguments = ", ".join(f"{key}={value!r}" for key, value in self.arguments.items() if value is not None)
        return f"Hertz({arguments})"


def _body(radii: Sequence[float] | Mapping[str, Any], E: float, nu: float) -> Any:
    """Table of a body in the scene."""
    if isinstance(radii, Mapping):
        return {"E": E, "nu": nu, **plain(radii)}
    return {"radii": plain(radii), "E": E, "nu": nu}
