"""Exudyn on a scene of bench/peers: exudyn_peer.py SCENE-NAME SECONDS.

Rigid bodies in absolute coordinates with all rows of every joint. The wheel has no C++ headers, and the equations
alone cannot be asked for from Python at a fair cost; so a step of its implicit integrator (one Newton iteration, dense
factors that take redundant rows) is timed as a part of a run of many, which leaves the call out.
"""

import sys
import time

import numpy as np

import mechanisms
import python_peer
import reference


def build(exu, scene, state):
    from exudyn.utilities import RigidBodyInertia

    container = exu.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.CreateGround()
    bodies = []
    for i, b in enumerate(scene.bodies):
        inertia = RigidBodyInertia(mass=b.mass, inertiaTensor=b.inertia + 1e-12 * np.eye(3))
        bodies.append(mbs.CreateRigidBody(inertia=inertia, referencePosition=list(state.p[i]), referenceRotationMatrix=state.R[i],
                                          initialVelocity=list(state.v[i]), initialAngularVelocity=list(state.w[i]),
                                          gravity=list(scene.gravity)))
    mechanics = reference.Mechanics(scene)
    for j in scene.joints:
        frame = mechanics._frame(state, j)
        place = mechanics._point(state, j.a, j.at)[1]
        axis = frame @ j.axis
        first, second = reference.two_across(axis)
        axes = np.column_stack([first, second, axis])
        free = [1, 1, 1, 1, 1, 0] if j.type == "revolute" else [1, 1, 0, 1, 1, 1]
        numbers = [ground if k == mechanisms.GROUND else bodies[k] for k in (j.a, j.b)]
        mbs.CreateGenericJoint(bodyNumbers=numbers, position=list(place), rotationMatrixAxes=axes, constrainedAxes=free,
                               useGlobalFrame=True)
        if scene.torques.get(j.name):
            mbs.CreateTorque(bodyNumber=bodies[j.b], loadVector=list(scene.torques[j.name] * axis))
    for s in scene.springs:
        ends = []
        for k, drawn in ((s.a, s.on_a), (s.b, s.on_b)):
            ends.append(list(drawn) if k == mechanisms.GROUND else list(drawn - scene.bodies[k].com))
        numbers = [ground if k == mechanisms.GROUND else bodies[k] for k in (s.a, s.b)]
        mbs.CreateSpringDamper(bodyNumbers=numbers, localPosition0=ends[0], localPosition1=ends[1], referenceLength=s.free_length,
                               stiffness=s.stiffness, damping=0)
    mbs.Assemble()
    return mbs, bodies


def run(exu, mbs, steps, step):
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = steps * step
    settings.timeIntegration.verboseMode = settings.timeIntegration.newton.useModifiedNewton = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.linearSolverType = exu.LinearSolverType.EigenDense
    settings.linearSolverSettings.ignoreSingularJacobian = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    start = time.process_time()
    mbs.SolveDynamic(settings, updateInitialValues=False)
    return time.process_time() - start


def main():
    import exudyn as exu

    exu.SetWriteToConsole(False)
    scene = next(s for s in mechanisms.all_scenes() if s.name == sys.argv[1])
    seconds = float(sys.argv[2])
    if len(scene.bodies) > 100:
        raise ValueError("dense factors of all rows of more than 100 bodies")
    states = reference.states_of(scene, 1)
    state, exact = states[0]
    start = time.process_time()
    mbs, bodies = build(exu, scene, state)
    load = time.process_time() - start
    step = float(python_peer.setting(sys.argv, "step", "1e-4"))
    run(exu, mbs, int(python_peer.setting(sys.argv, "first", "1")), step)
    got = np.zeros_like(exact)
    for i, body in enumerate(bodies):
        kinds = exu.OutputVariableType
        got[i, :3] = mbs.GetObjectOutputBody(body, kinds.Acceleration, [0, 0, 0])
        got[i, 3:] = mbs.GetObjectOutputBody(body, kinds.AngularAcceleration, [0, 0, 0])
    error = float(np.abs(got - exact).max() / np.abs(exact).max())
    few, many = 20, 60
    while run(exu, mbs, many, step) < 0.02 and many < 20000:
        few, many = 2 * few, 2 * many
    least = {few: float("inf"), many: float("inf")}
    begun = time.process_time()
    while True:
        for count in least:
            least[count] = min(least[count], run(exu, mbs, count, step))
        if time.process_time() - begun > seconds:
            break
    taken = (least[many] - least[few]) / (many - few)
    return {"us": 1e6 * taken, "error": error, "load_s": load, "version": exu.GetVersionString().split()[0]}


if __name__ == "__main__":
    python_peer.finish(main)
