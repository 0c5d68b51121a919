"""Contacts by name: wheelsets of a vehicle with profiles, friction, radius and model of their own."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from plane import mirror_signs

import wheelrail as wr
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.strip_places import at_places
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.vehicle_contact import ContactsByWheelset
from wheelrail.scenes.builders.vehicle import vehicle_on
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.runs.steady import equilibria_of, modes_of
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.scenes.views.view import bodies_of_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import in_threads
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

SCENE = (Path(__file__).parents[2] / "scenes" / "vehicle.toml").read_text(encoding="utf-8")
STRIPS = SCENE.replace(
    'model = "standard"', 'laws = "exact"\nbodies = "half-space"\nsurface_size = 1e-3\nstrips = 4\ncells = 6'
)
EQUAL = '[contacts.a]\nwheelsets = ["wheelset_1", "wheelset_3"]\n[contacts.b]\nwheelsets = ["wheelset_2"]\n'
OTHERS = """[contacts.slippery]
wheelsets = ["wheelset_1", "wheelset_4"]
friction = 0.1
[contacts.worn]
wheelsets = ["wheelset_2"]
profiles.{side} = {{ radius = 0.459, friction = 0.2 }}
"""


def scene(contacts: str, text: str = SCENE) -> RunScene:
    found = parse_scene(f"{text}\n{contacts}", "scene.toml")
    assert isinstance(found, RunScene)
    return found


@cache
def in_curve(contacts: str, curvature: float = 1 / 600) -> Equilibrium:
    return equilibria_of(scene(contacts), MANCHESTER, [25.0], ConstantCurve(25.0, curvature, 0.1))[0]


@cache
def into_a_curve(contacts: str, curvature: float = 1 / 600, end: float = 0.05, text: str = SCENE) -> History:
    track = Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)
    contact, _ = run_contact(scene(contacts, text), ())
    return simulate(VehicleDynamics(load_vehicle(), track, contact, 45.0), (0.0, end))


def test_names_of_equal_contacts_change_nothing() -> None:
    """Bitwise: wheelsets solved in three groups or in one, modes, runs in time."""
    one, several = in_curve(""), in_curve(EQUAL)
    np.testing.assert_array_equal(several.state, one.state)
    values = [[mode.eigenvalue for mode in modes_of(scene(text), MANCHESTER, [25.0])[0]] for text in ("", EQUAL)]
    assert values[0] == values[1]
    runs = [into_a_curve(text) for text in ("", EQUAL)]
    assert runs[0].status == "completed"
    np.testing.assert_array_equal(runs[1].state, runs[0].state)
    np.testing.assert_array_equal(runs[1].force, runs[0].force)


def test_names_of_equal_strips_change_nothing() -> None:
    """The same for strips, one after the other and by two threads; critical speeds have all places of the lattice."""
    runs = [into_a_curve(text, end=0.01, text=STRIPS).force for text in ("", EQUAL)]
    with in_threads(run_contact(scene(EQUAL, STRIPS), ())[0], 2) as contact:
        track = Track.curve(curvature=1 / 600, cant=0.06, transition=15.0, length=50.0)
        runs.append(simulate(VehicleDynamics(load_vehicle(), track, contact, 45.0), (0.0, 0.01)).force)
    np.testing.assert_array_equal(runs[1], runs[0])
    np.testing.assert_array_equal(runs[2], runs[0])
    places = at_places(run_contact(scene(EQUAL, STRIPS), ())[0], 4)
    assert [place.of("wheelset_2").model.offset for place in places] == [0.0, 0.25, 0.5, 0.75]  # type: ignore[attr-defined]
    assert len(at_places(run_contact(scene(EQUAL), ())[0], 4)) == 1


def test_mirror_image() -> None:
    left, right = (into_a_curve(OTHERS.format(side=s), way / 600) for s, way in (("left", 1), ("right", -1)))
    assert left.status == right.status == "completed"
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    assert not np.array_equal(left.state, into_a_curve("").state)


def forces(at: Equilibrium, wheelset: str) -> Array:
    return np.array([result.force for result in at.contacts[wheelset].values()])


def test_own_friction() -> None:
    """Without friction the sum of forces on wheelset_1 has no longitudinal part, which the others keep."""
    at = in_curve('[contacts.ice]\nwheelsets = ["wheelset_1"]\nfriction = 0.0\n')
    assert np.abs(forces(at, "wheelset_1")[:, 0]).max() < 600.0  # N, of the normal force at a yaw angle
    assert np.abs(forces(at, "wheelset_2")[:, 0]).min() > 3e3
    same = in_curve('[contacts.dry]\nwheelsets = ["wheelset_1"]\nfriction = 0.3\n')
    np.testing.assert_array_equal(same.state, in_curve("").state)


def test_own_radius() -> None:
    """Of all wheelsets as of the scene; of one, it rolls faster and sinks by the difference."""
    everywhere = "wheelsets = [" + ", ".join(f'"wheelset_{k}"' for k in (1, 2, 3, 4)) + "]\nradius = 0.458\n"
    of_scene = SCENE.replace("laying_angle", "left.radius = 0.458\nright.radius = 0.458\nlaying_angle")
    named, whole = (
        equilibria_of(one, MANCHESTER, [25.0])[0] for one in (scene(f"[contacts.a]\n{everywhere}"), scene("", of_scene))
    )
    np.testing.assert_array_equal(named.state, whole.state)
    one = equilibria_of(scene('[contacts.a]\nwheelsets = ["wheelset_2"]\nradius = 0.458\n'), MANCHESTER, [25.0])[0]
    states = one.dynamics.wheelset_states(one.time, one.state)
    spin = {name: state.pitch_rate for name, state in states.items()}
    assert spin["wheelset_2"] / spin["wheelset_1"] == pytest.approx(0.46 / 0.458, rel=2e-6)
    assert states["wheelset_2"].z - states["wheelset_1"].z == pytest.approx(-2e-3, abs=2e-5)


def test_keys_left_out_are_those_of_the_scene(tmp_path: Path) -> None:
    text = SCENE.replace("laying_angle", "right.friction = 0.2\nlaying_angle")
    found = scene('[contacts.a]\nwheelsets = ["wheelset_1"]\nprofiles.left.friction = 0.15\n', text)
    a = found.contact_of("wheelset_1")
    assert [a.side(side).friction for side in ("left", "right")] == [0.15, 0.2]
    assert found.contact_of("wheelset_2") is found
    b = scene('[contacts.a]\nwheelsets = ["wheelset_1"]\nfriction = 0.4\n', text).contact_of("wheelset_1")
    assert [b.side(side).friction for side in ("left", "right")] == [0.4, 0.4]  # also in place of that of one side
    other = '[contacts.a]\nwheelsets = ["wheelset_1"]\nmodel = "standard"\nnormal = "hertz"\n'
    assert scene(other, STRIPS).contact_of("wheelset_1").model == "standard"  # without strips and cells


def test_another_friction_shares_compliance_and_tables() -> None:
    text = '[contacts.a]\nwheelsets = ["wheelset_1"]\nfriction = 0.1\n'
    contact, _ = run_contact(scene(text, STRIPS), ())
    assert isinstance(contact, ContactsByWheelset)
    models = []
    for name in ("wheelset_1", "wheelset_2"):
        own = contact.of(name)
        assert isinstance(own, WheelsetContact)
        assert isinstance(own.model, LatticeContact)
        models.append(own.model)
    assert models[0].operators is models[1].operators
    assert models[0].tables is models[1].tables
    assert models[0].laws != models[1].laws


def test_pictures_have_the_wheels_of_each_wheelset() -> None:
    bodies = bodies_of_scene(scene(OTHERS.format(side="left")))
    assert [bodies.of(f"wheelset_{k}").on("left").rolling_radius for k in (1, 2, 3, 4)] == [0.46, 0.459, 0.46, 0.46]


def test_results_name_the_contact_of_each_wheelset(tmp_path: Path) -> None:
    text = re.sub(r"^tangent = .*$", "tangent = 1.0", SCENE, flags=re.MULTILINE)
    text = re.sub(r"^(transition_length|curve) = .*$", r"\1 = 1.0", text, flags=re.MULTILINE)
    (tmp_path / "scene.toml").write_text(f"{text}\n{OTHERS.format(side='left')}")
    data = wr.run(tmp_path / "scene.toml", vehicle=MANCHESTER).data
    assert data["contact"].values.tolist() == ["slippery", "worn", "", "slippery"]


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        ('[contacts.a]\nwheelsets = ["front"]', "contacts.a.wheelsets: must be one of wheelset_1, "),
        ("[contacts.a]\nfriction = 0.1", "contacts.a.wheelsets: missing"),
        ("[contacts.a]\nwheelsets = []", "contacts.a.wheelsets = []: must be"),
        (EQUAL.replace("_2", "_3"), 'contacts.b.wheelsets = ["wheelset_3"]: wheelset_3 has another contact'),
        ('[contacts.a]\nwheelsets = ["wheelset_1"]\nfriction = -1.0', "contacts.a.friction = -1.0: must be a number"),
        ('[contacts.a]\nwheelsets = ["wheelset_1"]\nmu = 0.1', "contacts.a.mu = 0.1: unknown key; did you mean "),
        ('[contacts.a]\nwheelsets = ["wheelset_1"]\ntrack.gauge = 1.4', "contacts.a.track: not allowed; that of the"),
        ('[contacts.a]\nwheelsets = ["wheelset_1"]\nmodel = "condensed"', "contacts.a.surface_size: missing"),
        ("[contacts]\na = 3", "contacts.a = 3: must be a table"),
        ("[[contacts]]\nfriction = 0.1", 'contacts = [{"friction": 0.1}]: must be a table'),
    ],
)
def test_invalid_contacts(contacts: str, message: str) -> None:
    with pytest.raises(SceneError, match=re.escape(message)):
        vehicle_on(scene(contacts), MANCHESTER)


def test_contact_of_an_unknown_wheelset() -> None:
    own = run_contact(scene(""), ())[0]
    with pytest.raises(InvalidVehicle, match="contact: of an unknown wheelset 'front': must be one of wheelset_1, "):
        VehicleDynamics(load_vehicle(), Track(), ContactsByWheelset(own, {"front": own}), 25.0)


def test_names_of_equal_contacts_change_nothing_on_elastic_track() -> None:
    """Axles and rails that move, of one wheelset on ballast: bitwise; and a contact of its own keeps its structure."""
    elastic = "[track.pads]\n[wheelset.axle]\n[wheelsets.wheelset_1]\nballast = true\n"
    vehicle, found = load_vehicle(), []
    for names in ("", EQUAL, '[contacts.a]\nwheelsets = ["wheelset_2"]\nfriction = 0.02\n'):
        contact, structures = run_contact(scene(elastic + names), vehicle.wheelsets)
        dynamics = VehicleDynamics(vehicle, ConstantCurve(25.0, 1 / 600, 0.1).track, contact, 25.0, structures)
        found.append(equilibrium(dynamics))
    np.testing.assert_array_equal(found[1].state, found[0].state)
    assert found[2].state.shape == found[0].state.shape
    assert found[2].residual < 1e-6
    slippery, dry = (forces(at, "wheelset_2") for at in (found[2], found[0]))
    assert (abs(slippery[:, 0]) < 0.021 * slippery[:, 2]).all()
    assert (abs(dry[:, 0]) > 0.05 * dry[:, 2]).all()
    with pytest.raises(SceneError, match=re.escape('contacts.a: allowed with model = "standard" only with')):
        scene(elastic + '[contacts.a]\nwheelsets = ["wheelset_1"]\ntangential = "polach"\n')
