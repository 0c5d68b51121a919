"""Scenes, validated on reading: a Hertz contact, a wheelset on its track, or a vehicle run."""

from __future__ import annotations

from collections.abc import Container, Mapping
from math import isinf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, get_args
from warnings import warn

from pydantic import (
    Field,
    Strict,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.laws import FrictionKey, FrictionTable, NormalTable
from wheelrail.scenes.schema.loads import BodyForceTable, TorqueTable
from wheelrail.scenes.schema.messages import validation_error, warn_of_unusual
from wheelrail.scenes.schema.profiles import SIDES, ProfilesTable, Side, SideTable
from wheelrail.scenes.schema.tables import (
    AxleTable,
    BlockStressTable,
    BodyTable,
    FallingTable,
    OutputTable,
    OwnWheelsetTable,
    RailsTable,
    SceneTable,
    Sides,
    SolverTable,
    StressTable,
    TabulatedTable,
    TrackTable,
    VehicleTable,
    WheelsetTable,
)
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.scenes.schema.track import TrackLine
from wheelrail.scenes.schema.wheelset_defaults import with_contacts, with_defaults
from wheelrail.support.text_file import present

if TYPE_CHECKING:
    from wheelrail.contact.models.discretisation import Discretisation
    from wheelrail.meshes.profiles.profile import Profile

STRAIGHT = 50.0  # m, radius above which the curvature of rails changes that of a flange's contact by 2.5 % at most
Model = Literal["condensed", "full", "standard", "table"]
MODELS: tuple[str, ...] = get_args(Model)
MOST_SAMPLES = 1_000_000  # kilobytes of memory each
ELEMENTS = ("cell", "bodies", "degree", "points", "strips", "cells", "slip_order")  # keys of elastic bodies


class Contact(SceneTable):
    """Keys of every scene.

    model: "condensed", "full", or "standard", the approximate contact of multibody codes without elements, which uses
        friction and falling, ignores surface_size, and has the keys normal, tangential and merge_distance; or "table",
        forces looked up in a file of `wheelrail table`.
    table: that file, relative to the scene's folder.
    laws: "exact" (unilateral contact and Coulomb friction, without constants), or "paper" (penalty pressure and
        regularised Coulomb friction), the default of runs. With "paper", stiffness_per_area = inf or
        regularisation = 0 makes one of the two exact.
    friction: coefficient of friction, or a table with a friction law and its constants; falling: decrease of the
        coefficient with the slip velocity.
    surface_size: edge of the surface cells, m.
    bodies: "solid" (3D meshes, the default with laws = "paper" or model = "full"), "waveguide" (bodies invariant along
        the track or about the axle, the default with laws = "exact"), or "half-space", for comparison with other codes.
    degree: of the displacements; 1 for solids by default.
    points: "lattice" (strips fixed on the wheel that end at the patch edge, the default for the exact normal law unless
        bodies are solid), or "grid", not available for half-spaces.
    strips, cells: of a lattice, over the width of a usual patch and along a strip; by default those of
        `LatticeResolution`.
    slip_order: order of the upstream difference formula of the slip on a grid.
    stiffness_per_area: penalty, N/m3; regularisation: creepage; normal_law: a table with a normal law in place of the
        linear penalty.
    """

    model: Model = "condensed"
    laws: Literal["paper", "exact"] = "exact"
    friction: FrictionKey
    falling: FallingTable | None = None
    surface_size: q.SurfaceSize | None = None
    normal: Literal["hertz", "kik-piotrowski"] | None = None
    tangential: Literal["fastsim", "polach"] | None = None
    merge_distance: q.MergeDistance | None = None
    cell: Literal["tetrahedron", "hexahedron"] = "tetrahedron"
    bodies: Literal["solid", "waveguide", "half-space"] | None = None
    degree: q.OneOrTwo | None = None
    points: Literal["lattice", "grid"] | None = None
    strips: q.Strips | None = None
    cells: q.Cells | None = None
    slip_order: q.OneOrTwo = 2
    stiffness_per_area: q.StiffnessPerArea = 1e15
    regularisation: q.Regularisation = 1e-5
    normal_law: NormalTable | None = None
    table: str | None = None

    @field_validator("table")
    @classmethod
    def _existing(cls, value: str | None, info: ValidationInfo) -> str | None:
        """The full path of the file."""
        if value is None:
            return None
        file = Path((info.context or {}).get("folder", "."), value)
        if not present(file):
            raise q.reject("must be an existing file, relative to the scene's folder")
        return str(file.absolute())

    @field_validator("*", mode="wrap")
    @classmethod
    def _once(cls, value: Any, check: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        """Accept tables that are already validated."""
        valid = isinstance(value, SceneTable) and type(value) is cls.model_fields[str(info.field_name)].annotation
        return value if valid else check(value)

    @model_validator(mode="after")
    def _lawful(self) -> Contact:
        if self.falling is not None and isinstance(self.friction, FrictionTable):
            raise q.reject('must not be combined with a friction law; use law = "falling"', "falling")
        if self.normal_law is not None and (self.laws == "exact" or not self.has_elements):
            raise q.reject('allowed only with laws = "paper" and model = "condensed" or "full"', "normal_law")
        if self.normal_law is not None and "stiffness_per_area" in self.model_fields_set:
            raise q.reject("must not be combined with normal_law", "stiffness_per_area")
        self._keys_of_other_models()
        if not self.has_elements:
            return self
        if self.surface_size is None:
            raise q.reject('required unless model = "standard" or "table"', "surface_size")
        if self.laws == "exact":
            for key in ("stiffness_per_area", "regularisation"):
                if key in self.model_fields_set:
                    raise q.reject('allowed only with laws = "paper"; the exact laws have no constants', key)
        from wheelrail.contact.models.discretisation import IncompatibleChoice

        try:
            _ = self.discretisation
        except IncompatibleChoice as error:
            raise q.reject(error.allowed, error.key) from None
        return self

    def _keys_of_other_models(self) -> None:
        """Raises a validation error for a key that the model does not have, and for a table that is missing."""
        if not self.has_elements:
            for key in ELEMENTS:
                if key in self.model_fields_set:
                    raise q.reject(
                        f'allowed only with model = "condensed" or "full"; model = "{self.model}" has no elements', key
                    )
        if self.model != "standard":
            for key in ("normal", "tangential", "merge_distance"):
                if getattr(self, key) is not None:
                    raise q.reject('allowed only with model = "standard"', key)
        if self.model != "table" and self.table is not None:
            raise q.reject('allowed only with model = "table"', "table")
        if self.model == "table" and self.table is None:
            raise q.reject('required with model = "table"', "table")
        if self.model == "table" and self.falling is not None:
            raise q.reject('not allowed with model = "table", which is of constant friction', "falling")

    @property
    def has_elements(self) -> bool:
        """Whether the model solves for elastic bodies."""
        return self.model in ("condensed", "full")

    @property
    def frictional(self) -> bool:
        """Whether there is a tangential problem."""
        return _frictional(self.friction)

    @property
    def discretisation(self) -> Discretisation:
        """Model, bodies, points and elements with all defaults resolved; raises IncompatibleChoice."""
        from wheelrail.contact.models.discretisation import Discretisation

        assert self.model == "condensed" or self.model == "full"
        assert self.surface_size is not None
        how = Discretisation(
            self.surface_size,
            model=self.model,
            bodies=self.bodies or ("solid" if self.laws == "paper" else None),
            points=self.points,
            degree=self.degree or 0,
            cell=self.cell,
            slip_order=self.slip_order,
            strips=self.strips,
            cells=self.cells,
        )
        exact = self.laws == "exact" or (self.normal_law is None and isinf(self.stiffness_per_area))
        return how.for_laws(exact=exact)


def _frictional(friction: float | FrictionTable) -> bool:
    return isinstance(friction, FrictionTable) or friction > 0.0


class OnRails(Contact):
    """Keys of scenes with wheels on rails."""

    E: q.Young
    nu: q.Poisson
    profiles: ProfilesTable
    wheelset: AxleTable
    track: RailsTable

    def side(self, name: Side) -> SideTable:
        """Profiles, radius and friction of one side."""
        own = self.profiles.of(name)
        shared = {"radius": self._radius, "friction": self.friction}
        return own.model_copy(update={key: value for key, value in shared.items() if getattr(own, key) is None})

    @property
    def _radius(self) -> float:
        """Rolling radius of both wheels, m."""
        return self.wheelset.radius

    @property
    def sides_alike(self) -> bool:
        """Whether one contact model serves both sides."""
        return self.side("left") == self.side("right")

    @property
    def frictional(self) -> bool:
        """Whether there is a tangential problem on a side."""
        return any(_frictional(self.side(name).friction or 0.0) for name in SIDES)

    @property
    def constant_friction(self) -> bool:
        """Whether friction is a constant coefficient on both sides."""
        laws = [friction for name in SIDES if isinstance(friction := self.side(name).friction, FrictionTable)]
        return self.falling is None and all(table.law == "coulomb" for table in laws)

    @property
    def elastic_keys(self) -> tuple[SceneTable | None, ...]:
        """Tables of axle and supports of the rails."""
        return self.wheelset.axle, self.track.pads, self.track.sleepers, self.track.ballast

    @property
    def is_flexible(self) -> bool:
        """Whether the axle bends or the rails move on pads."""
        return self.wheelset.axle is not None or self.track.pads is not None

    @property
    def allowed_on_elastic(self) -> str:
        """Contacts that are allowed on elastic axles and tracks in a run; empty for one of them."""
        if self.has_elements and (self.model == "full" or self.discretisation.points != "lattice"):
            return 'allowed in a run only with points = "lattice", that is laws = "exact" and model = "condensed"'
        known = self.normal != "hertz" and self.tangential != "polach" and self.constant_friction
        if self.model == "standard" and not known:
            allowed = 'allowed with model = "standard" only with "kik-piotrowski", "fastsim" and Coulomb friction'
            return f"{allowed}, whose forces have derivatives"
        return ""

    @property
    def _flexible_key(self) -> str:
        """Key of an elastic axle, or of pads; that of all single wheelsets if neither has them."""
        keys = {"wheelset.axle": self.wheelset.axle, "track.pads": self.track.pads}
        return next((key for key, value in keys.items() if value is not None), "wheelsets")

    @model_validator(mode="after")
    def _no_falling_law(self) -> OnRails:
        for name in SIDES:
            if self.falling is not None and isinstance(self.side(name).friction, FrictionTable):
                raise q.reject('must not be combined with a friction law; use law = "falling"', "falling")
        return self


def _between(wheelset: AxleTable, gauge: float) -> None:
    """Raises a validation error unless the flange backs fit between the rails."""
    if not wheelset.flange_back_distance < gauge:
        raise q.reject(f"must be less than the gauge of {gauge:g} m", "wheelset.flange_back_distance")


def _tabulated(scene: Contact, poisson: dict[str, float]) -> None:
    """Raises a validation error for Poisson's ratios, by key, outside Kalker's table of creep coefficients."""
    for key, nu in poisson.items():
        if scene.model == "standard" and scene.frictional and nu < 0.0:
            raise q.reject('must be at least 0 with model = "standard" and friction', key)


NO_STRESS = 'allowed only with model = "condensed" or "full"'


class Solve(Contact):
    """Keys of one contact solve; error_estimate: from two solves on half as many strips and cells."""

    error_estimate: bool = False

    @model_validator(mode="after")
    def _estimable(self) -> Solve:
        if self.error_estimate and (not self.has_elements or self.discretisation.points == "grid"):
            raise q.reject('allowed only with points = "lattice"', "error_estimate")
        return self


class HertzScene(Solve):
    """Two bodies with given principal radii under a load, N, or at an approach, m.

    With friction they roll at a speed, m/s, with a creepage, or undergo one tangential displacement (shift, m) of the
    upper body against the lower one (Cattaneo, Mindlin).

    half_width: of the blocks, and their depth, m; 40 to 80 times the longer semi-axis of the patch by default.
    half_strip: half length and half width of the uniformly meshed surface, m, which must contain the region of
        penetration; for the load by default.
    growth: of the element size of solids per distance from the surface, 0.2 by default; a mesh converges if it
        decreases in proportion to the surface size.
    """

    kind: Literal["hertz"]
    load: q.Load | None = None
    approach: q.Approach | None = None
    speed: q.Speed | None = None
    creepage: Annotated[tuple[q.Creepage, q.Creepage, q.Spin], Strict(False)] | None = None
    shift: Annotated[tuple[q.Shift, q.Shift], Strict(False)] | None = None
    half_width: q.BlockWidth | None = None
    half_strip: q.BlockWidth | None = None
    growth: q.Growth | None = None
    upper: BodyTable
    lower: BodyTable
    stress: BlockStressTable | None = None

    @model_validator(mode="after")
    def _meshed(self) -> HertzScene:
        bodies = self.discretisation.bodies if self.has_elements else None
        for key in ("half_width", "half_strip"):
            if getattr(self, key) is not None and bodies not in ("solid", "waveguide"):
                raise q.reject('allowed only with bodies = "solid" or "waveguide", which are meshed', key)
        if self.growth is not None and bodies != "solid":
            raise q.reject('allowed only with bodies = "solid"', "growth")
        return self

    @model_validator(mode="after")
    def _consistent(self) -> HertzScene:
        if self.model == "table":
            raise q.reject('must be "condensed", "full" or "standard" for a Hertz pair', "model")
        if (self.load is None) == (self.approach is None):
            raise q.reject("exactly one of load and approach is required", "load")
        for key in ("speed", "creepage"):
            if self.shift is not None and getattr(self, key) is not None:
                raise q.reject("must not be combined with shift", key)
            if self.shift is None and self.frictional and getattr(self, key) is None:
                raise q.reject("required if friction is not 0", key)
        if self.model == "standard" and self.merge_distance is not None:
            raise q.reject("not allowed for a Hertz pair, which has one contact point", "merge_distance")
        if not self.has_elements and self.stress is not None:
            raise q.reject(NO_STRESS, "stress")
        if self.shift is not None and self.model != "condensed":
            raise q.reject('allowed only with model = "condensed"', "shift")
        regularised = self.laws == "paper" and self.regularisation > 0.0
        varies = isinstance(self.friction, FrictionTable) and self.friction.law != "coulomb"
        if self.shift is not None and (self.falling or varies or regularised):
            raise q.reject(
                'allowed only with Coulomb friction: regularisation = 0 or laws = "exact", without falling', "shift"
            )
        _tabulated(self, {"upper.nu": self.upper.nu, "lower.nu": self.lower.nu})
        for name, upper, lower in zip("xy", self.upper.radii, self.lower.radii, strict=True):
            if not 1.0 / upper + 1.0 / lower > 0.0:
                text = (
                    f"must give point contact with lower.radii: 1/upper + 1/lower in {name} must be greater than 0 1/m"
                )
                raise q.reject(text, "upper.radii")
        return self


class WheelsetScene(OnRails, Solve):
    """One position of a wheelset on its track; keys that are missing have the defaults of `wheelrail.Wheelset`."""

    kind: Literal["wheelset"]
    sides: Sides = ("left", "right")
    track: TrackTable
    wheelset: WheelsetTable
    stress: StressTable | None = None

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        return with_defaults(data) if isinstance(data, Mapping) else data

    @model_validator(mode="after")
    def _consistent(self) -> WheelsetScene:
        if len(set(self.sides)) != len(self.sides):
            raise q.reject("must contain each side at most once", "sides")
        if len(self.sides) == 1 and (self.wheelset.axle_load is not None or self.wheelset.roll == "solve"):
            raise q.reject('must be ["left", "right"] with axle_load or roll = "solve"', "sides")
        if not self.has_elements and self.stress is not None:
            raise q.reject(NO_STRESS, "stress")
        self._flexible()
        _between(self.wheelset, self.track.gauge)
        _tabulated(self, {"nu": self.nu})
        return self

    def _flexible(self) -> None:
        """Raises a validation error where an elastic axle or pads do not fit."""
        if not self.is_flexible:
            return
        if not self.has_elements:
            raise q.reject('allowed only with model = "condensed" or "full"', self._flexible_key)
        if len(self.sides) == 1:
            raise q.reject('must be ["left", "right"] with wheelset.axle or track.pads', "sides")
        if self.wheelset.wheel_load is not None and self.wheelset.roll != "solve":
            raise q.reject('must be "solve" with wheel_load and wheelset.axle or track.pads', "wheelset.roll")


class NamedContact(OnRails):
    """Contact of some wheelsets of a vehicle file: their profiles, laws, friction and model.

    Keys that are left out are those of the scene, of which another model takes the profiles, material and friction.

    wheelsets: by name. radius: of the rolling circles of their wheels, m; the nominal heights stay.
    """

    laws: Literal["paper", "exact"] = "paper"
    wheelsets: Annotated[tuple[str, ...], Strict(False), Field(min_length=1)]
    radius: q.WheelRadius | None = None

    @property
    def _radius(self) -> float:
        return self.wheelset.radius if self.radius is None else self.radius

    @model_validator(mode="after")
    def _consistent(self) -> NamedContact:
        _tabulated(self, {"nu": self.nu})
        return self


class RunScene(OnRails):
    """A vehicle run along a track.

    contacts: of some wheelsets of a vehicle file, by name.
    kick: lateral velocities at the start by body, m/s to the left, of a vehicle file.
    torque, force: of motors and brakes on wheelsets, and on bodies, of a vehicle file.
    tabulated: table of the contact's forces, in place of elastic contact where it is good.
    wheelsets: axle and track of single wheelsets by name, of a vehicle file.
    """

    kind: Literal["run"]
    laws: Literal["paper", "exact"] = "paper"
    track: TrackLine
    vehicle: VehicleTable
    solver: SolverTable = SolverTable()
    output: OutputTable = OutputTable()
    contacts: dict[str, NamedContact] | None = None
    kick: dict[str, q.KickVelocity] | None = None
    torque: Annotated[tuple[TorqueTable, ...], Strict(False), q.AtMost(1000)] | None = None
    force: Annotated[tuple[BodyForceTable, ...], Strict(False), q.AtMost(1000)] | None = None
    tabulated: TabulatedTable | None = None
    wheelsets: dict[str, OwnWheelsetTable] | None = None

    def on_wheelset(self, name: str) -> RunScene:
        """The scene with axle and track of one wheelset for all."""
        own = (self.wheelsets or {}).get(name)
        if own is None:
            return self.model_copy(update={"wheelsets": None})
        changed = {key: getattr(own, key) for key in own.model_fields_set}
        axle = {"axle": changed.pop("axle")} if "axle" in changed else {}
        tables = {"wheelset": self.wheelset.model_copy(update=axle), "track": self.track.model_copy(update=changed)}
        return self.model_copy(update={**tables, "wheelsets": None})

    @property
    def is_flexible(self) -> bool:
        """Whether an axle bends or rails move on pads."""
        return super().is_flexible or any(self.on_wheelset(name).is_flexible for name in self.wheelsets or {})

    @model_validator(mode="after")
    def _own_supports(self) -> RunScene:
        for name in self.wheelsets or {}:
            try:
                self.on_wheelset(name).track.require_pads()
            except PydanticCustomError as error:
                context = error.context or {}
                raise q.reject(str(context["allowed"]), f"wheelsets.{name}.{context['key']}") from None
        return self

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        if not (isinstance(data, Mapping) and isinstance(data.get("contacts"), Mapping)):
            return data
        return with_contacts(data, OnRails.model_fields, RailsTable.model_fields)

    @model_validator(mode="after")
    def _one_contact_each(self) -> RunScene:
        owners = dict[str, str]()
        for name, contact in (self.contacts or {}).items():
            for wheelset in contact.wheelsets:
                if wheelset in owners:
                    text = f"{wheelset} has another contact, contacts.{owners[wheelset]}"
                    raise q.reject(text, f"contacts.{name}.wheelsets")
                owners[wheelset] = name
        return self

    def contact_of(self, wheelset: str) -> OnRails:
        """Contact of a wheelset: its own one, or that of the scene."""
        return next((own for own in (self.contacts or {}).values() if wheelset in own.wheelsets), self)

    @model_validator(mode="after")
    def _clears_check_rail(self) -> RunScene:
        if (table := self.track.check_rail) is None:
            return self
        named = {f"contacts.{name}: ": own for name, own in (self.contacts or {}).items()}
        for name, own in {"": self, **named}.items():
            least = 0.5 * (own.track.gauge - own.wheelset.flange_back_distance)
            if not table.flangeway > least:
                text = f"{name}must be greater than {least:g} m, at which flanges of a centred wheelset touch"
                raise q.reject(text, "track.check_rail.flangeway")
            for side in table.sides:
                if table.friction is None and not isinstance(own.side(side).friction, float):
                    raise q.reject(f"{name}required: the contact has a friction law", "track.check_rail.friction")
        return self

    @model_validator(mode="after")
    def _samples(self) -> RunScene:
        from wheelrail.vehicle.track.speed_profile import SpeedProfile

        _between(self.wheelset, self.track.gauge)
        _tabulated(self, {"nu": self.nu})
        if self.output.interval:
            shortest = SpeedProfile.of(self.vehicle.speed_profile).time_at(self.track.length) / MOST_SAMPLES
            if self.output.interval < shortest:
                raise q.reject(
                    f"must be 0, or at least {shortest:.2g} s, for at most {MOST_SAMPLES} samples", "output.interval"
                )
        return self

    @property
    def takes_rails_as_straight(self) -> bool:
        """Whether forces come from tables, which have no curvature of rails in plan."""
        own = (self, *(self.contacts or {}).values())
        return self.tabulated is not None or any(contact.model == "table" for contact in own)

    @property
    def keys_of_vehicle_files(self) -> list[str]:
        """Keys that are used, and allowed only with a vehicle file."""
        used = [key for key in ("contacts", "wheelsets", "kick", "torque", "force") if getattr(self, key)]
        return [*used, "vehicle.free_speed"] if self.vehicle.free_speed else used

    @model_validator(mode="after")
    def _flexible(self) -> RunScene:
        if self.is_flexible:
            named = {f"contacts.{name}": own for name, own in (self.contacts or {}).items()}
            for key, own in {self._flexible_key: self, **named}.items():
                if allowed := own.allowed_on_elastic:
                    raise q.reject(allowed, key)
        return self

    @model_validator(mode="after")
    def _tabulable(self) -> RunScene:
        """Raises a validation error where forces of the elastic contacts are no function of pose and creepages."""
        if self.tabulated is None:
            return self
        key = "tabulated"
        own = [contact for contact in (self, *(self.contacts or {}).values()) if contact.has_elements]
        if not own or any(contact.model == "full" or contact.discretisation.points != "lattice" for contact in own):
            raise q.reject('allowed only with laws = "exact" and model = "condensed" on strips', key)
        if not all(contact.constant_friction for contact in own):
            raise q.reject("allowed only with a constant coefficient of friction", key)
        if self.track.friction is not None:
            raise q.reject("not allowed with track.friction: tables are of constant friction", key)
        return self

    @model_validator(mode="after")
    def _equal_radii(self) -> RunScene:
        if self.vehicle.changed and self.vehicle.on(self.wheelset.radius).radius != self.wheelset.radius:
            raise q.reject("wheelset.height of the wagon must equal wheelset.radius of the scene", "vehicle")
        return self


Scene: TypeAlias = HertzScene | WheelsetScene | RunScene
KINDS: dict[str, type[HertzScene] | type[WheelsetScene] | type[RunScene]] = {
    "hertz": HertzScene,
    "wheelset": WheelsetScene,
    "run": RunScene,
}


def load_scene(path: str | Path) -> Scene:
    """Validated scene of a TOML file.

    Parameters:
        path: scene file.

    Warns of unusual values. Raises SceneError naming file, key, value and what is allowed.
    """
    return warned(parse_scene(read_text(Path(path)), path), path)


def warned(scene: Scene, path: str | Path, unnamed: Container[str] = ()) -> Scene:
    """The scene, after warnings of its unusual values; parameters as for `checked`."""
    if isinstance(scene, RunScene) and scene.takes_rails_as_straight and scene.track.sharpest > 1.0 / STRAIGHT:
        text = f"tables of forces take rails as straight, which errs by microns at flanges below {STRAIGHT:g} m"
        warn(f"{path}: track: {text}", stacklevel=2)
    other_wagon = isinstance(scene, RunScene) and scene.vehicle.changed
    warn_of_unusual(scene, path, unnamed, scene.vehicle.on(None) if other_wagon else None)  # type: ignore[union-attr]
    return scene


def parse_scene(text: str, path: str | Path = "scene") -> Scene:
    """Validated scene of a TOML text.

    Parameters:
        text: TOML.
        path: its file, for errors; paths in the scene are relative to its folder.
    """
    return checked(parse(text, path), path)


def checked(
    data: Mapping[str, Any],
    path: str | Path = "scene",
    *,
    given: Mapping[str, Profile] | None = None,
    unnamed: Container[str] = (),
) -> Scene:
    """Validated scene of tables.

    Parameters:
        data: tables.
        path: their file, for errors; paths in the scene are relative to its folder.
        given: profiles passed as objects, by the names that the tables have in place of files.
        unnamed: tables to omit from the names of keys in errors.

    Raises SceneError as `load_scene`.
    """
    kind = data.get("kind")
    model = KINDS.get(kind) if isinstance(kind, str) else None
    if model is None:
        entry = f"kind = {repr(kind)[:100]}" if "kind" in data else "kind: missing"
        raise SceneError(f"{path}: {entry}: must be one of {', '.join(map(repr, KINDS))}")
    try:
        return model.model_validate(data, context={"folder": Path(path).parent, "given": given or {}})
    except ValidationError as error:
        raise validation_error(error, model, data, path, unnamed) from None


__all__ = ["HertzScene", "RunScene", "Scene", "SceneError", "WheelsetScene", "checked", "load_scene", "parse_scene"]
