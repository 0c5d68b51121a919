"""Time of a look-up in a table of contact forces beside the model that it was made from.

    wheelrail table SCENE --out FILE
    python -m benchmarks.table_lookup FILE

Microseconds of processor time: the compiled look-up alone, called in compiled code at changing positions; the
derivative by all twelve changes of pose and motion; a contact of one wheel as runs call it, in Python. Shortest of ten
parts. The table's errors, which it stores, are printed with them.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

from benchmarks.common.machine import machine_description
from wheelrail.bindings._contact import table_force
from wheelrail.cli.output import print_results
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.models.table.force_table import ForceTable
from wheelrail.contact.models.table.model import TableContact
from wheelrail.scenes.datasets.force_table import force_tables
from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.tables.make import table_results

PARTS, CALLS = 10, 2000
SPEED = 20.0  # m/s


def middle(table: ForceTable) -> tuple[Pose, RigidMotion]:
    """Pose at the middle of all ranges, between nodes, and rolling with both creepages."""
    y, roll, yaw = (low + 0.51 * (high - low) for low, high in table.ranges.values())
    normal = table.normal
    place = (len(normal.y) // 2 * len(normal.roll) + len(normal.roll) // 2) * len(normal.yaw) + len(normal.yaw) // 2
    heights = normal.values.reshape(-1, len(normal.level), 9)[place, :, 0]
    pose = table.frame.pose(y, float(heights[len(heights) // 2]), roll, yaw)
    spin = 1.001 * SPEED / table.frame.radius
    wheel = Twist(np.array([0.0, 0.02, 0.0]), spin * pose.rotation[:, 1], pose.origin)
    return pose, RigidMotion(wheel, Twist(np.array([-SPEED, 0.0, 0.0]), np.zeros(3), np.zeros(3)))


def microseconds(call: Callable[[], object], count: int) -> float:
    """Processor time of one of `count` calls inside a call, the shortest of several parts, us."""
    call()
    times = []
    for _ in range(PARTS):
        start = process_time()
        call()
        times.append(process_time() - start)
    return 1e6 * min(times) / count


def costs(table: ForceTable) -> dict[str, float]:
    """Processor times, us."""
    pose, motion = middle(table)
    contact = TableContact(table)
    arguments = table.arguments(pose, motion)
    return {
        "look-up": microseconds(lambda: [table_force(*arguments) for _ in range(CALLS)], CALLS),
        "derivative (6 x 12)": microseconds(lambda: [table.derivative(pose, motion) for _ in range(20)], 20),
        "contact of a wheel in Python": microseconds(lambda: [contact(pose, motion) for _ in range(100)], 100),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path, help="of `wheelrail table`")
    file = parser.parse_args().file
    data = read(file)
    print(f"{machine_description()}\n")
    for side, table in force_tables(data, file).items():
        print(f"| {side} | us |\n|---|---|")
        for name, value in costs(table).items():
            print(f"| {name} | {value:.2f} |")
    print()
    print_results(table_results(data, file))


if __name__ == "__main__":
    main()
