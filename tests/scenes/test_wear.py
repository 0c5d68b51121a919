"""Wear of wheels over a duty: conservation, hands, shares, resume, renewed bodies, bad files, pictures."""

from __future__ import annotations

import gc
import shutil
import weakref
from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from xarray import Dataset

import wheelrail as wr
from wheelrail.api.wear import Wear
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.scenes.html_report import write_report
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.wear.cases import Duty
from wheelrail.scenes.wear.jobs import workers
from wheelrail.scenes.wear.loop import WearLoop
from wheelrail.scenes.wear.schema import check_wear
from wheelrail.scenes.wear.tables import remarks
from wheelrail.vehicle.wear.evolution import WearingProfile
from wheelrail.vehicle.wear.smoothing import smoothed

SCENES = Path(__file__).parents[2] / "scenes"
VEHICLE = {"scene": str(SCENES / "vehicle.toml"), "vehicle": str(SCENES / "manchester_vehicle.toml")}
SHARP = {"curvature": 1.0 / 600.0, "cant": 0.1, "speed": 25.0}
WIDE = {"curvature": 1.0 / 1200.0, "cant": 0.06, "speed": 35.0}
VARIED = {"share": 1.0, "steady": WIDE, "vary": {"friction": [0.2, 0.4]}}
RAILS = ["60E1", "UIC60-benchmark"]
DUTY = {"share": 0.6, "steady": WIDE, "both_hands": True}, {"share": 0.4, "steady": SHARP, "name": "sharp"}
SECONDS = "seconds"
pytestmark = pytest.mark.usefixtures("coarse_conicities")


def wear(
    *duty: Mapping[str, Any],
    folder: Path | None = None,
    resume: bool = False,
    executor: Executor | None = None,
    **more: Any,
) -> Dataset:
    """Results of some cases."""
    table = check_wear({**VEHICLE, "law": {"name": "usfd", "scale": 0.18}, "until": 1.0, "duty": duty, **more})
    return WearLoop(Duty(table, Path("wear.toml")), folder, executor=executor).run(resume=resume)


@cache
def sharp(until: float, both_hands: bool = False) -> Dataset:
    """Of both sides of a vehicle in a sharp curve to the left, or in curves of both hands."""
    return wear({"share": 1.0, "steady": SHARP, "both_hands": both_hands}, profiles="sides", until=until)


@pytest.fixture(scope="module")
def steps(tmp_path_factory: pytest.TempPathFactory) -> tuple[Dataset, Path]:
    """Three steps of two curves, and their folder."""
    folder = tmp_path_factory.mktemp("wear")
    return wear(*DUTY, folder=folder, until=4e6, depth=1e-4), folder


def test_what_is_worn_is_removed(steps: tuple[Dataset, Path]) -> None:
    """Sections are rates times distance, and lie between the profiles."""
    data, _ = steps
    assert data.attrs["status"] == "completed"
    assert data["distance"].values[-1] == 4e6
    distance = np.diff(data["distance"].values)
    removed = data["removed_area"].values[:, 0].sum(axis=1)
    rate = data["area_rate"].values[:-1, 0].sum(axis=1)
    np.testing.assert_allclose(removed[1:], np.cumsum(distance * rate), rtol=1e-12)
    np.testing.assert_allclose(data["removed_section"].values[1:, 0], removed[1:], rtol=1e-5)
    by_case = np.einsum("c,kcps->kps", data["share"].values, data["depth_rate"].values[:-1])
    width = np.diff(data["s"].values).mean()
    np.testing.assert_allclose(width * by_case, data["area_rate"].values[:-1], rtol=1e-10, atol=1e-30)
    assert np.diff(data["depth"].values.max(axis=(1, 2))).max() <= 1.001e-4
    assert (data["outside_rate"].values[:-1] <= 1e-6 * rate[:, None]).all()


def test_fatigue_is_smoothed_as_the_wear_of_its_step(steps: tuple[Dataset, Path]) -> None:
    """The sum of the damage stays, its peaks do not."""
    data, _ = steps
    width, length = float(np.diff(data["s"]).mean()), data["smoothing_length"].values[0, 0]
    table = {**VEHICLE, "law": {"name": "usfd", "scale": 0.18}, "until": 4e6, "depth": 1e-4, "duty": DUTY}
    duty = Duty(check_wear(table), Path("wear.toml"))
    new = WearLoop(duty)._unworn()
    rates = WearLoop(duty)._case_rates(new, list(enumerate(duty.cases)))
    raw = np.stack([own.rates.wheels["wheel"].damage for own in rates]) / width
    damage = data["damage_rate"].values[0, :, 0]
    np.testing.assert_allclose(damage.sum(axis=1), raw.sum(axis=1), rtol=1e-9)
    np.testing.assert_allclose(damage, [smoothed(own, length, width) for own in raw], rtol=1e-9, atol=1e-20)
    assert damage.max() < 0.9 * raw.max()


def test_energy_of_the_cells_is_that_of_the_patches(steps: tuple[Dataset, Path]) -> None:
    """Over the circumference of each cell it is T-gamma of a wheel."""
    data, _ = steps
    radius = 0.46 + data["new_z"].values[0]
    width = np.diff(data["s"].values).mean()
    energy = (data["energy_rate"].values[:-1, :, 0] * 2.0 * np.pi * radius * width).sum(axis=2)
    np.testing.assert_allclose(energy, data["t_gamma"].values[:-1], rtol=1e-9)


def test_a_killed_loop_resumes_with_all_bits(steps: tuple[Dataset, Path], tmp_path: Path) -> None:
    data, folder = steps
    shutil.copytree(folder / "steps", tmp_path / "steps")
    files = sorted((tmp_path / "steps").iterdir())
    for file in files[1:]:
        file.unlink()
    (tmp_path / "steps" / "00001.nc.part").write_bytes(b"half")
    resumed = wear(*DUTY, folder=tmp_path, resume=True, until=4e6, depth=1e-4)
    xarray.testing.assert_equal(resumed.drop_vars(SECONDS), data.drop_vars(SECONDS))
    with pytest.raises(SceneError, match="of another wear; omit --resume"):
        wear(*DUTY, folder=tmp_path, resume=True, until=4e6, depth=2e-4)


def test_a_case_that_hardly_counts_is_solved_now_and_then(monkeypatch: pytest.MonkeyPatch) -> None:
    """All cases solved in each step wear the same within a tenth of the error of the steps."""
    strips = {"bodies": "half-space", "strips": 4, "cells": 8, "model": "condensed", "surface_size": 1e-3}
    change = {"set": {**strips, "laws": "exact"}}
    table = {**VEHICLE, "law": {"name": "usfd", "scale": 0.18}, "until": 2e6, "depth": 5e-5}
    gentle = {"share": 0.06, "name": "gentle", "steady": {**WIDE, "curvature": 1.0 / 2500.0}, **change}
    duty = Duty(check_wear({**table, "duty": [{"share": 0.94, "steady": WIDE, **change}, gentle]}), Path("wear.toml"))
    words = list[str]()
    data = WearLoop(duty, report=lambda _, said: words.append(said)).run()
    gentle_solves = [said for said in words if said.endswith("gentle")]
    assert 2 <= len(gentle_solves) < len(words) - len(gentle_solves) - 1
    monkeypatch.setattr("wheelrail.scenes.wear.loop.UNCHANGED", 0.0)
    every = WearLoop(duty).run()
    depth, expected = data["depth"].values[-1], every["depth"].values[-1]
    largest = float(np.nanmax(every["step_error"].values))
    assert 0.0 < np.linalg.norm(depth - expected) < 0.1 * largest * np.linalg.norm(expected)


def test_processes_wear_with_all_bits(steps: tuple[Dataset, Path]) -> None:
    data, _ = steps
    with workers(2, None) as executor:
        other = wear(*DUTY, until=4e6, depth=1e-4, executor=executor)
        failing = {"share": 1.0, "name": "slow", "scene": str(SCENES / "vehicle_irregular.toml"), "start": 1e3}
        with pytest.raises(RuntimeError, match="duty 'slow': start = 1000 m: no row"):
            wear({**failing, "set": {"track.segments": [{"kind": "tangent", "length": 12.0}]}}, executor=executor)
    xarray.testing.assert_equal(other.drop_vars(SECONDS), data.drop_vars(SECONDS))
    with pytest.raises(SceneError, match="workers = 0: must be at least 1"), workers(0, None):
        pass


@pytest.mark.parametrize("axle", [{}, {"wheelset.axle": {"diameter": 0.16}, "track.pads": {}}])
def test_another_contact_wears_at_the_loads_of_the_motion(axle: dict[str, Any]) -> None:
    """The motion's own contact, taken for another one, repeats its wear; on the loads of `standard` nearly so."""
    strips = {"bodies": "half-space", "strips": 4, "cells": 8, "model": "condensed", "surface_size": 1e-3}
    elastic = {"share": 1.0, "steady": WIDE, "set": {**strips, "laws": "exact", **axle}}
    own, again = (wear(elastic, contact=contact) for contact in ({}, {"E": 210e9 * (1.0 + 1e-9)}))
    np.testing.assert_allclose(again["t_gamma"].values[0], own["t_gamma"].values[0], rtol=1e-5)
    rate = own["area_rate"].values[0, 0]
    np.testing.assert_allclose(again["area_rate"].values[0, 0], rate, atol=1e-5 * rate.max())
    lifted = wear({"share": 1.0, "steady": WIDE, "set": axle}, contact={**strips, "laws": "exact"})
    standard = wear({"share": 1.0, "steady": WIDE, "set": axle})
    np.testing.assert_allclose(lifted["t_gamma"].values[0], own["t_gamma"].values[0], rtol=0.05)
    assert (lifted["area_rate"].values[0] != standard["area_rate"].values[0]).any()


def test_rows_of_a_run_are_lifted() -> None:
    """Wheels on irregular rails start from their last rows; another interval gives the same rows in between."""
    tangent = {"track.segments": [{"kind": "tangent", "length": 16.0}]}
    run = {"share": 1.0, "scene": str(SCENES / "vehicle_irregular.toml"), "set": tangent, "start": 15.9}
    contact = {"model": "condensed", "laws": "exact", "bodies": "half-space", "surface_size": 1e-3, "strips": 6}
    cold, warm = (
        wear({**run, "start": start}, contact=contact, interval=4.0)["t_gamma"].values[0, 0] for start in (15.9, 11.9)
    )
    first = wear(
        {**run, "start": 11.9, "set": {"track.segments": [{"kind": "tangent", "length": 12.1}]}},
        contact=contact,
        interval=4.0,
    )
    assert first["failed_share"].values[0, 0] == 0.0
    assert warm == pytest.approx(0.5 * (cold + first["t_gamma"].values[0, 0]), rel=2e-2)


def test_hands_are_mirror_images_and_shares_linear() -> None:
    left = sharp(5e5)
    right = wear({"share": 1.0, "steady": {**SHARP, "curvature": -1.0 / 600.0}}, profiles="sides", until=5e5)
    depth, mirrored = left["depth"].values[-1], right["depth"].values[-1, ::-1]
    assert depth.max() > 1e-6
    np.testing.assert_allclose(depth, mirrored, atol=1e-9)
    assert abs(depth[0] - depth[1]).max() > 0.3 * depth.max()
    both = sharp(1e5, both_hands=True)
    rates = both["depth_rate"].values[0, 0]
    np.testing.assert_allclose(rates[0], 0.5 * left["depth_rate"].values[0, 0].sum(axis=0), atol=1e-9 * rates.max())
    one = wear({"share": 1.0, "steady": SHARP})
    np.testing.assert_allclose(one["depth_rate"].values[0, 0, 0], rates[0], atol=1e-9 * rates.max())
    cases = {"share": 0.25, "steady": SHARP}, {"share": 0.75, "steady": WIDE}
    mixed = wear(*cases, until=1.0)
    expected = 0.25 * mixed["depth_rate"].values[0, 0] + 0.75 * mixed["depth_rate"].values[0, 1]
    width = np.diff(mixed["s"].values).mean()
    np.testing.assert_allclose(mixed["area_rate"].values[0], width * expected, rtol=1e-12, atol=1e-30)


def test_varied_values_are_cases_with_their_weights() -> None:
    """A list is the same as its cases written out; dotted names need no quotes."""
    friction = [0.2, 0.4], [0.25, 0.75]
    listed = wear(
        {"share": 1.0, "steady": SHARP, "vary": {"friction": friction[0]}, "weights": {"friction": friction[1]}}
    )
    apart = wear(
        *(
            {"share": w, "steady": SHARP, "name": f"{mu}", "set": {"friction": mu}}
            for mu, w in zip(*friction, strict=True)
        )
    )
    assert listed["case"].values.tolist() == [f"1: R 600 m, 25 m/s, friction = {mu}" for mu in friction[0]]
    np.testing.assert_array_equal(listed["share"].values, friction[1])
    np.testing.assert_array_equal(listed["area_rate"].values, apart["area_rate"].values)
    vary = {"profiles": {"rail": ["60E1", "UIC60-benchmark"]}, "steady": {"speed": [20.0, 30.0]}}
    table = check_wear(
        {**VEHICLE, "law": {"name": "usfd"}, "until": 1.0, "duty": [{"share": 1.0, "steady": WIDE, "vary": vary}]}
    )
    cases = Duty(table, Path("wear.toml")).cases
    assert [(case.scene.profiles.rail, case.table.steady.speed, case.table.share) for case in cases] == [  # type: ignore[union-attr]
        (rail, speed, 0.25) for rail in ("60E1", "UIC60-benchmark") for speed in (20.0, 30.0)
    ]


def test_a_turned_vehicle_wears_both_sides_alike() -> None:
    """Half with the vehicle as it stands, half with its left wheels on the right, as in two curves of both hands."""
    left, both = sharp(5e5), sharp(1e5, both_hands=True)
    turned = wear({"share": 1.0, "steady": SHARP}, profiles="sides", turned=True, until=1e5)
    assert turned["case"].values.tolist() == ["1: R 600 m, 25 m/s", "1: R 600 m, 25 m/s, turned"]
    largest = both["area_rate"].values[0].max()
    np.testing.assert_allclose(turned["area_rate"].values[0], both["area_rate"].values[0], atol=1e-6 * largest)
    assert abs(left["area_rate"].values[0] - both["area_rate"].values[0]).max() > 0.3 * largest
    np.testing.assert_allclose(turned["depth"].values[-1, 0], turned["depth"].values[-1, 1], atol=1e-11)


def test_rails_wear_by_passages_with_their_own_clock(tmp_path: Path) -> None:
    """Sections are passages times rates; rails are renewed at their depth only; a killed loop ends in the same bits."""
    duty = {"share": 1.0, "steady": SHARP, "vary": {"friction": [0.2, 0.3]}, "name": "sharp"}
    more = {"until": 1.2e5, "depth": 5e-5, "rails": {"passages": 0.5, "depth": 4e-5}}
    data = wear(duty, folder=tmp_path, **more)
    assert data.attrs["status"] == "completed"
    assert data["rail"].values.tolist() == ["sharp, inner rail", "sharp, outer rail"]
    passed = 0.5 * np.diff(data["distance"].values)
    removed = np.nansum(data["rail_removed_area"].values, axis=2)
    np.testing.assert_allclose(removed[-1], passed @ np.nansum(data["rail_area_rate"].values[:-1], axis=2), rtol=1e-12)
    np.testing.assert_allclose(data["rail_section"].values[-1], removed[-1], rtol=1e-4)
    inner, outer = np.count_nonzero(np.diff(removed, axis=0), axis=0)
    assert outer > inner > 0
    assert np.nanmax(np.diff(data["rail_depth"].values, axis=0)) <= 4e-5
    drawn = Wear(data).plot.rails()
    assert [ax.get_title(loc="left") + ax.get_title() for ax in drawn] == ["sharp, inner rail", "sharp, outer rail"]
    new = named_profile("60E1").inclined(1.0 / 40.0)
    worn = Wear(data).profile(new, name="sharp, outer rail")
    assert worn.measures(new).removed_section == pytest.approx(data["rail_section"].values[-1, 1], rel=1e-9)
    assert "Wear of the rails after 6e+04 wheelsets" in repr(Wear(data))
    for file in sorted((tmp_path / "steps").iterdir())[2:]:
        file.unlink()
    resumed = wear(duty, folder=tmp_path, resume=True, **more)
    xarray.testing.assert_equal(resumed.drop_vars(SECONDS), data.drop_vars(SECONDS))


def test_worn_rails_stay_in_their_place() -> None:
    """The gauge of a worn rail is wide."""
    table = {**VEHICLE, "law": {"name": "usfd"}, "until": 1.0, "duty": [{"share": 1.0, "steady": SHARP}]}
    duty = Duty(check_wear({**table, "rails": {"passages": 1.0}}), Path("wear.toml"))
    rails = {name: rail.profile for name, rail in duty.unworn_rails().items()}
    worn = {name: replace(own, removed=np.full(len(own.removed), 1e-3 * own.width)) for name, own in rails.items()}
    profiles = [duty.unworn() | own for own in (rails, worn)]
    with (
        duty.contacts(profiles[0], profiles[0], duty.cases) as new,
        duty.contacts(profiles[1], profiles[1], duty.cases) as old,
    ):
        (first,), (second,) = new.values(), old.values()
        assert isinstance(first.motion, WheelsetContact)
        assert isinstance(second.motion, WheelsetContact)
        assert first.motion.mounting == second.motion.mounting
        assert first.motion.model is not second.motion.model


def test_hands_wear_rails_of_both() -> None:
    """In curves of both hands, wheels of both sides wear alike, and rails as in one hand alone."""
    more = {"profiles": "sides", "rails": {"passages": 0.5}, "until": 1e5}
    both = wear({"share": 1.0, "steady": SHARP, "both_hands": True}, **more)
    one = wear({"share": 1.0, "steady": SHARP}, **more)
    assert both["rail"].values.tolist() == one["rail"].values.tolist()
    rates = [own["rail_area_rate"].values[0] for own in (both, one)]
    np.testing.assert_allclose(rates[0], rates[1], atol=1e-6 * rates[1].max())
    worn = both["depth"].values[-1]
    np.testing.assert_allclose(worn[0], worn[1], atol=1e-10)


def test_rows_of_a_run_wear_and_limits_turn_the_wheels() -> None:
    """A vehicle that runs straight wears its tread alike on both sides; it is turned as soon as it is hollow."""
    tangent = {"track.segments": [{"kind": "tangent", "length": 12.0}]}
    run = {"share": 1.0, "scene": str(SCENES / "vehicle_irregular.toml"), "set": tangent, "start": 4.0}
    data = wear(run, until=3e5, step=1e5, reprofile={"hollow": 0.0, "Sh": 0.028}, interval=1.0)
    assert data["turned"].values[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert (data["depth"].values[1:] == 0.0).all()
    assert data["t_gamma"].values[0, 0] > 0.0


def test_bodies_are_renewed_with_the_depth() -> None:
    """Strips on the compliance of a profile 0.1 mm ago wear as on that of the present one."""
    change = {"bodies": "half-space", "strips": 6, "cells": 10, "model": "condensed", "surface_size": 1e-3}
    case = {"share": 1.0, "steady": WIDE, "set": {**change, "laws": "exact"}}
    kept, renewed = (wear(case, until=5e5, depth=1e-4, renew=renew) for renew in (2e-3, 1e-6))
    rates = [data["area_rate"].values[1, 0] for data in (kept, renewed)]
    assert rates[0].sum() == pytest.approx(rates[1].sum(), rel=5e-3)
    np.testing.assert_allclose(rates[0], rates[1], atol=0.02 * rates[1].max())  # strips lie elsewhere
    np.testing.assert_allclose(kept["t_gamma"].values[1], renewed["t_gamma"].values[1], rtol=2e-3)


def test_bodies_are_made_once_and_freed_before_the_next() -> None:
    """Before, those of a renewed profile were made again a step later, beside earlier ones that nothing used."""
    change = {"bodies": "half-space", "strips": 6, "cells": 10, "model": "condensed", "surface_size": 1e-3}
    case = {"share": 1.0, "steady": WIDE, "set": {**change, "laws": "exact"}}
    table = {**VEHICLE, "law": {"name": "usfd", "scale": 0.18}, "until": 1.0, "duty": [case]}
    duty = Duty(check_wear(table), Path("wear.toml"))
    new = duty.unworn()
    worn = [
        {name: replace(own, removed=1e-5 * n * own.width + own.removed) for name, own in new.items()} for n in (1, 2)
    ]

    def upper(present: Mapping[str, WearingProfile], renewed: Mapping[str, WearingProfile]) -> Any:
        with duty.contacts(present, renewed, duty.cases, threads=1) as contacts:
            motion = next(iter(contacts.values())).motion
            assert isinstance(motion, WheelsetContact)
            return motion.model.operators.upper  # type: ignore[attr-defined]

    first = weakref.ref(upper(new, new))
    assert upper(worn[0], new) is first()
    second = upper(worn[0], worn[0])
    gc.collect()
    assert first() is None
    assert upper(worn[1], worn[0]) is second


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"duty": [{"share": 0.5, "steady": WIDE}]}, r"duty = .*shares sum to 0.5: must be 1|shares sum to 0.5"),
        ({"law": {"name": "holm"}}, "law = .*must be one of archard|name = 'holm': must be one of archard"),
        ({"law": {"name": "archard", "hardness": 0.0}}, "hardness = 0.0: must be a finite number, positive"),
        ({"scene": "none.toml"}, "scene = 'none.toml'|must be an existing file"),
        ({"until": 0.0}, "until = 0.0: must be"),
        ({"duty": [{"share": 1.0, "both_hands": True}]}, "both_hands.*allowed only with steady"),
        ({"duty": [{"share": 0.5, "name": "a"}, {"share": 0.5, "name": "a"}]}, "name = 'a': must be that of one case"),
        ({"duty": [{"share": 1.0, "set": {"friction": 3.0}}]}, "duty '1: run': .*friction = 3.0"),
        ({"duty": [{"share": 1.0, "scene": str(SCENES / "wheelset.toml")}]}, 'kind = "wheelset": must be "run"'),
        (
            {"duty": [{"share": 0.5}, {"share": 0.5, "set": {"wheelset.radius": 0.4}}]},
            "has another left wheel|must be 0.4 m, wheelset.radius of the scene",
        ),
        (
            {"duty": [{**VARIED, "weights": {"friction": [0.5, 0.6]}}]},
            "weights: friction: weights sum to 1.1: must be 1",
        ),
        (
            {"duty": [{**VARIED, "weights": {"mu": [0.5, 0.5]}}]},
            "weights: mu: must have a weight for each of its values",
        ),
        ({"duty": [{**VARIED, "vary": {"steady.speed": [-3.0]}}]}, r"vary: steady: speed = -3.0: must be a number"),
        ({"duty": [{**VARIED, "vary": {"friction": [0.3, 0.3]}}]}, "vary: friction: 0.3 must be listed once"),
        ({"duty": [{**VARIED, "set": {"friction": 0.3}}]}, "friction: must be in set or in vary"),
        (
            {"duty": [{**VARIED, "vary": {"profiles.rail": RAILS}}], "rails": {"passages": 1.0}},
            "rail .* must be the same",
        ),
        ({"rails": {"passages": 0.0}}, "rails.passages = 0.0: must be a number from"),
    ],
)
def test_bad_files(change: dict[str, Any], says: str) -> None:
    table = {**VEHICLE, "law": {"name": "usfd"}, "until": 1e6, "duty": [{"share": 1.0, "steady": WIDE}], **change}
    with pytest.raises(SceneError, match=says):
        Duty(check_wear(table, "wear.toml"), Path("wear.toml"))


def test_a_case_that_fails_is_named() -> None:
    run = {"share": 1.0, "name": "too short", "scene": str(SCENES / "vehicle_irregular.toml"), "start": 100.0}
    short = {"track.segments": [{"kind": "tangent", "length": 12.0}]}
    with pytest.raises(RuntimeError, match="duty 'too short': start = 100 m: no row of the run lies beyond it"):
        wear({**run, "set": short}, until=1e6)


def test_remarks_tell_what_limits_results(steps: tuple[Dataset, Path], tmp_path: Path) -> None:
    data, _ = steps
    said = "; ".join(remarks(data))
    assert "over the last step: shorter steps" in said
    assert "branch above 77.2 N/mm2" in said
    narrow = data.copy(deep=True)
    narrow["depth_rate"].values[0, 0, 0] = np.where(np.abs(data["s"].values) < 4e-3, 1e-12, 0.0)
    assert "100 % of its wear lies in 10 mm: a groove" in "; ".join(remarks(narrow))
    assert "limits 6.5" not in said
    assert "sharper" not in said
    worn, km = data.copy(deep=True), f"{1e-3 * data['distance'].values[-1]:.0f} km"
    worn["qR"].values[-1] = 6.4e-3
    worn["groove"].values[-1] = 3e-3
    told = "; ".join(remarks(worn))
    assert f"wheel, {km}: qR = 6.40 mm, limits 6.5" in told
    assert f"wheel, from {km} on: grooves sharper than gauge corners of rails, to a radius of 3.0 mm" in told
    assert "sharper" not in "; ".join(remarks(worn.drop_vars("groove")))  # of an older version
    straight = {"share": 1.0, "steady": {"curvature": 0.0, "speed": 30.0}}
    assert wear(straight, folder=tmp_path / "new", resume=True).attrs["status"] == "completed"


def test_report(steps: tuple[Dataset, Path], tmp_path: Path) -> None:
    """One page with tables, remarks and figures; results of something else are refused."""
    _, folder = steps
    page = write_report(folder, tmp_path / "wear.html").read_text(encoding="utf-8")
    for text in (
        "Wear of wheel profiles over 4000 km",
        "completed",
        "shorter steps (depth) may differ",
        "branch above",
    ):
        assert text in page
    assert page.count("<img") == 5
    assert 'name = "usfd"' in page.replace("&#34;", '"')
    Dataset({"a": 1.0}).to_netcdf(tmp_path / "wear.nc")
    with pytest.raises(SceneError, match=r"wear\.nc: contains no results of wear"):
        write_report(tmp_path)


def test_python(steps: tuple[Dataset, Path]) -> None:
    data, folder = steps
    results = wr.open(folder / "wear.nc")
    assert isinstance(results, wr.Wear)
    assert "Wear of the profile 'wheel'" in repr(results)
    assert results.status == "completed"
    worn = results.profile(named_profile("S1002"))
    assert worn.measures(named_profile("S1002")).removed_section == pytest.approx(
        data["removed_section"].values[-1, 0], rel=1e-9
    )
    with pytest.raises(ValueError, match="is not the profile that wore"):
        results.profile(named_profile("60E1"))
    drawn = results.plot()
    assert set(drawn) == {"profiles", "depth", "measures", "duty", "fatigue"}
    (ax,) = results.plot.profiles(scale=10.0)
    assert "magnified 10 times" in ax.get_title(loc="left") + ax.get_title()
    assert (ax.get_xlabel(), ax.yaxis_inverted()) == ("y, positive to the field side [mm]", True)
