"""The plane wagon on `LinearContact` in Exudyn (J. Gerstmayr, Multibody System Dynamics 60 (2024), DOI
10.1007/s11044-023-09937-1).

Exudyn's x and y are y and z here, its rotation is the roll. Its bodies, markers, contact springs, roll spring, gravity
and integrator are used unchanged. Suspension elements are user functions: Exudyn's spring in the axes of a body uses
the difference of velocities instead of the rate of the deflection, and omits the moment of the gap.
"""

from __future__ import annotations

from collections.abc import Callable

import exudyn as exu
import exudyn.itemInterface as item
import numpy as np

from benchmarks.exudyn.linear_contact import LinearContact
from wheelrail.vehicle.wagon.wagon import Wagon

Array = np.ndarray
Law = Callable[[float, float, float, float], tuple[float, float]]  # deflection and its rate to the pull of the element


def trajectory(
    wagon: Wagon, contact: LinearContact, initial: Array, *, end: float, every: float, step: float, order: str = "RK67"
) -> Array:
    """Positions (n, 9) at intervals s: y, z m from the nominal position and roll rad of the three bodies.

    initial (18,): positions, then rates; step s of the explicit Runge-Kutta method, named as in Exudyn.
    """
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    w = wagon.plane
    bodies = [(b.mass, b.roll_inertia, b.height) for b in (w.car_body, w.bogie, w.wheelset)]
    nodes, objects = [], []
    for i, (mass, inertia, height) in enumerate(bodies):
        node = mbs.AddNode(
            item.NodeRigidBody2D(
                referenceCoordinates=[0.0, height, 0.0],
                initialCoordinates=initial[3 * i : 3 * i + 3].tolist(),
                initialVelocities=initial[9 + 3 * i : 12 + 3 * i].tolist(),
            )
        )
        body = mbs.AddObject(item.ObjectRigidBody2D(nodeNumber=node, mass=mass, inertia=inertia))
        marker = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(item.LoadMassProportional(markerNumber=marker, loadVector=[0.0, -w.gravity, 0.0]))
        nodes.append(node)
        objects.append(body)

    def point(body: int, y: float, height: float) -> int:
        place = [y, height - bodies[body][2], 0.0]
        return int(mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=objects[body], localPosition=place)))

    def element(upper: int, lower: int, y: float, height: float, law: Law) -> None:
        """Tensile force between upper and lower body in the axes of the lower one, at the point of the upper one."""

        def pulled(gap: Array, velocity: Array) -> tuple[float, float]:
            turning = mbs.GetNodeOutput(nodes[lower], exu.OutputVariableType.AngularVelocity)[2]
            return law(gap[0], gap[1], velocity[0] + turning * gap[1], velocity[1] - turning * gap[0])

        def force(mbs, t, number, gap, rotation, velocity, spin, stiffness, damping, j0, j1, offset):  # type: ignore
            return [*pulled(gap, velocity), 0.0, 0.0, 0.0, 0.0]

        spring = mbs.AddObject(
            item.ObjectConnectorRigidBodySpringDamper(
                markerNumbers=[point(lower, y, height), point(upper, y, height)], springForceTorqueUserFunction=force
            )
        )

        def moment(mbs, t, load):  # type: ignore
            gap = mbs.GetObjectOutput(spring, exu.OutputVariableType.DisplacementLocal)
            fy, fz = pulled(gap, mbs.GetObjectOutput(spring, exu.OutputVariableType.VelocityLocal))
            return [0.0, 0.0, gap[0] * fz - gap[1] * fy]

        centre = point(lower, 0.0, bodies[lower][2])
        mbs.AddLoad(
            item.LoadTorqueVector(markerNumber=centre, loadVector=[0.0, 0.0, 0.0], loadVectorUserFunction=moment)
        )

    for stage, upper, lower, mass in (
        (w.secondary, 0, 1, bodies[0][0]),
        (w.primary, 1, 2, bodies[0][0] + bodies[1][0]),
    ):
        for side in (1.0, -1.0):
            spring = _spring(stage.lateral_stiffness, stage.vertical_stiffness, 0.5 * mass * w.gravity)
            damper = _damper(stage.lateral_damping, stage.vertical_damping)
            element(upper, lower, side * stage.spring_y, stage.spring_height, spring)
            element(upper, lower, side * stage.damper_y, stage.damper_height, damper)
    table = np.array(w.bumpstop.points).T
    slope = (table[1][-1] - table[1][-2]) / (table[0][-1] - table[0][-2])  # extrapolation beyond the table
    table = np.append(table[0], 1.0), np.append(table[1], table[1][-1] + slope * (1.0 - table[0][-1]))
    element(0, 1, 0.0, w.bumpstop_height, lambda y, z, vy, vz: (float(np.sign(y) * np.interp(abs(y), *table)), 0.0))

    ends = [mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[i], coordinate=2)) for i in (1, 0)]
    couple = w.roll_bar + 2 * w.secondary.bending_stiffness
    mbs.AddObject(item.ObjectConnectorCoordinateSpringDamper(markerNumbers=ends, stiffness=couple))
    ground = mbs.AddObject(item.ObjectGround())
    for b in (contact.across, -contact.across):
        foot = mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=ground, localPosition=[b, 0.0, 0.0]))
        (k_y, c_y), (k_z, c_z) = contact.lateral, contact.vertical
        mbs.AddObject(
            item.ObjectConnectorCartesianSpringDamper(
                markerNumbers=[foot, point(2, b, bodies[2][2] - contact.radius)],
                stiffness=[k_y, k_z, 0.0],
                damping=[c_y, c_z, 0.0],
                offset=[0.0, contact.load / k_z, 0.0],
            )
        )
    variable = exu.OutputVariableType.Coordinates
    sensors = [
        mbs.AddSensor(item.SensorNode(nodeNumber=n, outputVariableType=variable, storeInternal=True)) for n in nodes
    ]
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = end
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = every
    mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, order))
    rows = [mbs.GetSensorStoredData(sensor) for sensor in sensors]
    if not np.allclose(rows[0][:, 0], every * np.arange(round(end / every) + 1), rtol=0.0, atol=1e-9):
        raise RuntimeError(f"every = {every} s: must be a multiple of step = {step} s")
    return np.concatenate([row[:, 1:4] for row in rows], axis=1)


def _spring(k_y: float, k_z: float, preload: float) -> Law:
    return lambda y, z, vy, vz: (k_y * y, k_z * z - preload)


def _damper(c_y: float, c_z: float) -> Law:
    return lambda y, z, vy, vz: (c_y * vy, c_z * vz)
