"""XDMF files of the fields on a solid's mesh, by DOLFINx, for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from wheelrail.contact.stress.fields import CIRCULAR_ORDER, BodyFields
from wheelrail.forms import compat
from wheelrail.support.arrays import Array
from wheelrail.support.atomic_file import check_space

MILLIMETRE, MEGAPASCAL = 1e3, 1e-6
OVERHEAD = 65_536  # bytes of an HDF5 file besides its arrays


def write_xdmf(fields: BodyFields, file: Path) -> tuple[Path, Path]:
    """Write displacement, mm, stress and von Mises stress, MPa, on the mesh of a solid, mm.

    Parameters:
        fields: on tetrahedra or hexahedra.
        file: to write, .xdmf; the values are in an .h5 file of the same name.

    Returns both files. Raises OSError for a file that cannot be written, before it is begun where the disk is full:
    HDF5 would print its trace, and may crash at the end of the process.
    """
    from dolfinx.io import XDMFFile

    cells = fields.cells[:, CIRCULAR_ORDER] if fields.shape == "hexahedron" else fields.cells
    mesh = compat.mesh_from_arrays(MPI.COMM_SELF, fields.shape, cells, MILLIMETRE * fields.points)
    values = {
        "displacement": MILLIMETRE * fields.displacement,
        "stress": MEGAPASCAL * fields.stress,
        "von Mises stress": MEGAPASCAL * fields.von_mises,
    }
    check_space(file, OVERHEAD + sum(array.nbytes for array in (cells, fields.points, *values.values())))
    try:
        with XDMFFile(MPI.COMM_SELF, str(file), "w") as xdmf:
            xdmf.write_mesh(mesh)
            for name, value in values.items():
                xdmf.write_function(_nodal(mesh, name, fields.points, value))
    except RuntimeError as error:  # of HDF5
        raise OSError(f"{file}: cannot be written: {error}") from error
    return file, file.with_suffix(".h5")


def _nodal(mesh: Any, name: str, points: Array, values: Array) -> Any:
    """Linear function on a mesh from values (n, ...) at its points (n, 3) m."""
    from dolfinx.fem import Function

    function = Function(compat.nodal_space(mesh, values.shape[1:]))
    function.name = name
    places = function.function_space.tabulate_dof_coordinates()
    _, order = cKDTree(MILLIMETRE * points).query(places)
    function.x.array[:] = np.asarray(values[order]).ravel()
    return function
