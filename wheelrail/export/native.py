"""Export of a wheelset's contact to one file, and of the native library that solves the contact."""

from __future__ import annotations

import logging
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail import bindings
from wheelrail.api.elements.checks import FRICTION, WHEEL_LOAD
from wheelrail.api.elements.wheelset_arrays import LIMITS
from wheelrail.bindings._contact import DEFAULT_FILE, AllowedRange, LatticeFile, StandardData, law_file, sealed_wheelset
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.laws.friction import Coulomb
from wheelrail.contact.laws.pointwise import friction_library
from wheelrail.contact.models.lattice.file import lattice_data
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.export.host import loaded_inputs
from wheelrail.scenes.builders.wheelset import wheel_sphere
from wheelrail.support.cache import one_process

if TYPE_CHECKING:
    from wheelrail.api.wheelset import Wheelset
    from wheelrail.scenes.schema.quantities import Range

log = logging.getLogger(__name__)

LIBRARY = "lib/libwheelrail.so"  # in a folder of its own: Python takes others for modules


def needs_python(wheelset: Wheelset) -> str:
    """Part of a wheelset's contact that only Python solves; empty without one."""
    contact = wheelset.element().contact
    if not isinstance(contact, WheelsetContact):
        return "an elastic axle and elastic pads"
    return next(filter(None, (_in_python(contact.of(side).model) for side in SIDES)), "")


def _in_python(model: ContactModel) -> str:
    if isinstance(model, LatticeContact) and isinstance(model.operators.surfaces, ProfileStrips):
        return ""
    if isinstance(model, StandardContact):
        return "" if model.data is not None else "Hertz's pressure, or friction that depends on the slip"
    return "solids and tables"


def write_native(wheelset: Wheelset, folder: Path, token: str = "") -> None:
    """Write the files of the native library: contact and law of friction.

    Parameters:
        wheelset: whose contact it is.
        folder: to write to.
        token: of a functional mock-up unit.

    Raises ValueError for a load that cannot be carried, OSError.
    """
    contact = wheelset.element().contact
    assert isinstance(contact, WheelsetContact)
    of_sides = [contact.of(side) for side in SIDES]
    models = [_data(own.model, folder) for own in of_sides[: 1 if contact.right is None else 2]]
    friction = [_coefficient(own.model) for own in of_sides]
    content = sealed_wheelset(
        token,
        loaded_inputs(wheelset),
        [_allowed(limits) for limits in LIMITS],
        (friction[0], friction[1]),
        _allowed(FRICTION),
        _allowed(WHEEL_LOAD),
        wheel_sphere(wheelset.arguments["E"], wheelset.arguments["nu"]),
        (of_sides[0].mounting.dimensions, of_sides[1].mounting.dimensions),
        models,
    )
    (folder / DEFAULT_FILE).write_bytes(content)


def _data(model: ContactModel, folder: Path) -> StandardData | LatticeFile:
    """Data of a contact model for the native library; its law of friction is written."""
    if isinstance(model, StandardContact):
        assert model.data is not None
        return model.data
    assert isinstance(model, LatticeContact)
    library = friction_library(model.laws.friction)
    name, seal = law_file(library)
    (folder / name).write_bytes(library)
    return LatticeFile(lattice_data(model), seal)


def _coefficient(model: ContactModel) -> float:
    """Coefficient of friction of a model, NaN of a law that is no number."""
    assert isinstance(model, StandardContact | LatticeContact)
    law = model.laws.friction
    return law.mu if isinstance(law, Coulomb) else float("nan")


def copy_library(target: Path) -> None:
    """Copy the library of this processor; beside its sources it is brought up to date. Raises OSError."""
    library = bindings.FOLDER / LIBRARY
    build = bindings.HERE.parents[1] / "bindings"
    if bindings.FOLDER.parent == bindings.HERE and (build / "build.ninja").exists():
        if not library.exists():
            log.info("compiling %s for this processor, once: a minute", library.name)
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', os.defpath)}"
        ninja = shutil.which("ninja", path=path) or "ninja"
        command = [ninja, "-C", str(build), f"library-{bindings.FOLDER.name}"]
        with one_process("library"):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise OSError(f"{' '.join(command)} failed: {(done.stderr or done.stdout)[-2000:]}")
    shutil.copyfile(library, target)


def _allowed(limits: Range) -> AllowedRange:
    return AllowedRange(limits.low, limits.high, str(limits))
