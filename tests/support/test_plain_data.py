"""Plain data: every bit is kept, and bytes from elsewhere run no code."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult, Fields, LazyFields, LazyPatches, Patch, Statistics
from wheelrail.support.plain_data import NotPlainData, decode, encode
from wheelrail.vehicle.multibody.coordinates import VehicleState

PACKAGES = ("wheelrail.contact", "wheelrail.vehicle")


def again(value: Any) -> Any:
    return decode(encode(value), PACKAGES)


def crafted(classes: object = (), arrays: object = (), value: object = None, elements: bytes = b"") -> bytes:
    return json.dumps({"classes": classes, "arrays": arrays, "value": value}).encode() + b"\n" + elements


def test_numbers_texts_and_containers_keep_type_and_bits() -> None:
    value = {
        "numbers": (1, True, None, 0.1, -0.0, 1e-310, float("inf"), 2**80),
        3: ["a line\nand \u20ac", [], (), {}],
        (1.5, "key"): np.float64(1 / 3),
        "small": (np.float32(0.1), np.int64(-5), np.bool_(True), np.complex128(1 - 2j)),
    }
    copy = again(value)
    assert repr(copy) == repr(value)
    assert list(map(type, copy["small"])) == list(map(type, value["small"]))
    assert np.isnan(again(float("nan")))


@pytest.mark.parametrize(
    "array",
    [
        np.random.default_rng(1).normal(size=(3, 4)),
        np.asfortranarray(np.arange(12.0).reshape(3, 4)),
        np.arange(24.0).reshape(2, 3, 4)[:, ::2, ::-1],
        np.zeros((0, 3)),
        np.array(2.5),
        np.array([True, False]),
        np.arange(5, dtype=">i2"),
        np.array([np.nan, -np.inf, -0.0]),
    ],
)
def test_arrays_keep_type_shape_order_and_bits(array: np.ndarray[Any, Any]) -> None:
    copy = again(array)
    assert (copy.dtype, copy.shape, copy.tobytes()) == (array.dtype, array.shape, array.tobytes())
    assert copy.flags.f_contiguous == (array.flags.f_contiguous or array.copy().flags.f_contiguous)
    assert copy.flags.writeable


def test_an_array_that_occurs_twice_is_stored_once() -> None:
    array = np.ones(1000)
    one, other = again((array, [array]))
    assert one is other[0]
    assert len(encode((array, [array]))) < 1.1 * array.nbytes


def test_nested_objects_of_the_package() -> None:
    patch = Patch(
        1.0, 2.0, 3.0, np.ones(3), (1.0, 2.0), (1.0, 2.0), 0.1, 0.2, 0.3, 0.4, 0.5, (0.0, 1.0), (0.0, 1.0), 0.0, 1.0
    )
    shape = np.zeros(2)
    fields = LazyFields(lambda: Fields(*12 * (shape,)))
    result = ContactResult(
        np.ones(3),
        np.zeros(3),
        LazyPatches(lambda: (patch,)),
        fields,
        statistics=Statistics(newton=3),
        warm_start=VehicleState(*3 * (shape,)),
    )
    copy = again(result)
    assert isinstance(copy, ContactResult)
    assert type(copy.fields) is Fields
    assert type(copy.patches) is tuple
    assert repr(copy) == repr(result)
    assert repr(copy.warm_start) == repr(result.warm_start)


@pytest.mark.parametrize("value", [object(), {1, 2}, len, b"bytes", np.array([None]), np.array(["text"]), 1 + 2j])
def test_other_values_are_not_written(value: object) -> None:
    with pytest.raises(TypeError, match="no plain data"):
        encode([value])


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x80\x04N.",
        b"[" * 100_000,
        b"{}",
        crafted(value={}),
        crafted(value=["unknown", 1]),
        crafted(value=["array", 0]),
        crafted(value=["dict", [["list"], 1]]),
        crafted(arrays=[["|O", [1], "C"]], value=["array", 0], elements=bytes(8)),
        crafted(arrays=[["<f8", [-1], "C"]], value=["array", 0], elements=bytes(8)),
        crafted(arrays=[["<f8", [2], "C"]], value=["array", 0], elements=bytes(8)),
        crafted(arrays=[["<f8", [1], "C"]], value=["array", 0], elements=bytes(9)),
        crafted(arrays=[["<f8", [2**70, 0], "C"]], value=["array", 0]),
        crafted(arrays=[["<f3", [1], "C"]], value=["array", 0], elements=bytes(3)),
        crafted(classes=[["subprocess", "Popen", ["args"]]], value=["object", 0, "ls"]),
        crafted(classes=[["wheelrail.support.terminal", "Path", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.vehicle.simulation.history", "dataclass", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.vehicle.simulation.history", "Sequence", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.vehicle.no_such_module", "Row", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.vehicle..", "Row", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.contact.results.result", "LazyPatches", []]], value=["object", 0]),
        crafted(classes=[["wheelrail.contact.results.result", "Statistics", ["newton"]]], value=["object", 0, 1]),
        crafted(
            classes=[["wheelrail.vehicle.multibody.coordinates", "VehicleState", [*VehicleState._fields]]],
            value=["object", 0, 1],
        ),
    ],
)
def test_crafted_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(NotPlainData):
        decode(data, PACKAGES)


def test_nothing_of_a_class_is_called() -> None:
    class_entry = ["wheelrail.contact.models.wheelset", "WheelsetContact", ["model", "mounting", "right"]]
    made = decode(crafted(classes=[class_entry], value=["object", 0, None, None, None]), PACKAGES)
    assert isinstance(made, WheelsetContact)


def test_truth_values_are_zero_or_one() -> None:
    made = decode(crafted(arrays=[["|b1", [3], "C"]], value=["array", 0], elements=b"\x00\x01\x07"), PACKAGES)
    assert made.view(np.uint8).tolist() == [0, 1, 1]
