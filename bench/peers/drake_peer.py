"""Drake on a scene of bench/peers: drake_peer.py scene.json SECONDS [step=S] [mode=forward|inverse].

The wheel has no C++ headers, so the fastest Python calls are timed and the time of an empty call is subtracted for
each. Open trees: derivatives of a continuous plant. Closed loops: ball constraints exist for discrete plants only, so
one update of the SAP solver is timed, and the acceleration is the change of velocity over a short step.
"""

import json
import sys
import time

import numpy as np
import pydrake
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, LinearSpringDamper, PrismaticJoint, RevoluteJoint, RotationalInertia, SpatialInertia

import python_peer


def build(scene, step):
    plant = MultibodyPlant(time_step=step)
    if step > 0:
        plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        plant.SetUseSampledOutputPorts(False)
    plant.mutable_gravity_field().set_gravity_vector(scene["gravity"])
    bodies, origins, joints = {-1: plant.world_body()}, {-1: np.zeros(3)}, {}
    for index, joint in scene["tree"]:
        b = scene["bodies"][index]
        origin = np.array(b["com"] if joint < 0 else scene["joints"][joint]["at"])
        com = np.array(b["com"]) - origin
        i = np.array(b["inertia"]).reshape(3, 3)
        central = RotationalInertia(i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
        bodies[index] = plant.AddRigidBody(b["name"], SpatialInertia.MakeFromCentralInertia(b["mass"], com, central))
        origins[index] = origin
        if joint < 0:
            continue
        j = scene["joints"][joint]
        child_is_b = j["b"] == index
        other = j["a"] if child_is_b else j["b"]
        frame = plant.AddFrame(FixedOffsetFrame(f"{j['name']}_frame", bodies[other].body_frame(),
                                                RigidTransform(origin - origins[other]), None))
        axis = np.array(j["axis"]) * (1 if child_is_b else -1)
        kind = RevoluteJoint if j["type"] == "revolute" else PrismaticJoint
        joints[joint] = plant.AddJoint(kind(j["name"], frame, bodies[index].body_frame(), axis))
        if j["torque"]:
            plant.AddJointActuator(f"{j['name']}_motor", joints[joint])
    for index in scene["cut"]:
        j = scene["joints"][index]
        if j["type"] != "revolute":
            raise ValueError("a prismatic joint that closes a loop")
        for side in (-0.5, 0.5):
            at = np.array(j["at"]) + side * np.array(j["axis"])
            plant.AddBallConstraint(bodies[j["a"]], at - origins[j["a"]], bodies[j["b"]], at - origins[j["b"]])
    for s in scene["springs"]:
        plant.AddForceElement(LinearSpringDamper(bodies[s["a"]], np.array(s["on_a"]) - origins[s["a"]], bodies[s["b"]],
                                                 np.array(s["on_b"]) - origins[s["b"]], s["free_length"], s["stiffness"], 0.0))
    plant.Finalize()
    return plant, bodies, joints


def main():
    scene = json.load(open(sys.argv[1], encoding="utf-8"))
    seconds = float(sys.argv[2])
    step = float(python_peer.setting(sys.argv, "step", "1e-4")) if scene["cut"] else 0.0
    start = time.process_time()
    plant, bodies, joints = build(scene, step)
    context = plant.CreateDefaultContext()
    load = time.process_time() - start
    if plant.num_actuators():
        plant.get_actuation_input_port().FixValue(context, [scene["joints"][j]["torque"] for j in joints if scene["joints"][j]["torque"]])
    states = []
    for state in scene["states"]:
        for index, joint in joints.items():
            set_one = joint.set_angle if isinstance(joint, RevoluteJoint) else joint.set_translation
            set_rate = joint.set_angular_rate if isinstance(joint, RevoluteJoint) else joint.set_translation_rate
            set_one(context, state["q"][index])
            set_rate(context, state["v"][index])
        for f in state["free"]:
            from pydrake.common.eigen_geometry import Quaternion
            from pydrake.multibody.math import SpatialVelocity

            pose = RigidTransform(RotationMatrix(Quaternion(f["quaternion"])), f["place"])
            plant.SetFreeBodyPose(context, bodies[f["body"]], pose)
            plant.SetFreeBodySpatialVelocity(bodies[f["body"]], SpatialVelocity(f["spin"], f["velocity"]), context)
        states.append(np.array(plant.GetPositionsAndVelocities(context)))
    starts = {index: joint.velocity_start() for index, joint in joints.items()}
    nq = plant.num_positions()

    if scene["cut"]:
        def evaluate(i):
            plant.SetPositionsAndVelocities(context, states[i])
            return plant.EvalUniquePeriodicDiscreteUpdate(context)

        def accelerations(i):
            after = np.array(evaluate(i).get_vector().value())
            return (after[nq:] - states[i][nq:]) / step
    else:
        def evaluate(i):
            plant.SetPositionsAndVelocities(context, states[i])
            return plant.EvalTimeDerivatives(context)

        def accelerations(i):
            return np.array(evaluate(i).CopyToVector())[nq:]

    worst, accelerated = 0.0, []
    for i, state in enumerate(scene["states"]):
        got = accelerations(i)
        accelerated.append(got)
        exact = np.array([state["a"][j] for j in starts])
        worst = max(worst, float(np.abs(np.array([got[v] for v in starts.values()]) - exact).max() / np.abs(exact).max()))
    if python_peer.setting(sys.argv, "mode", "forward") == "inverse":
        from pydrake.multibody.tree import MultibodyForces

        none = MultibodyForces(plant)

        def evaluate(i):
            plant.SetPositionsAndVelocities(context, states[i])
            return plant.CalcInverseDynamics(context, accelerated[i], none)

    taken = python_peer.least_microseconds(evaluate, len(states), seconds)
    empty = python_peer.least_microseconds(lambda i: plant.num_positions(), len(states), min(seconds, 0.1))
    return {"us": max(taken - 2 * empty, 0.0), "overhead_us": 2 * empty, "error": worst, "load_s": load, "version": pydrake.__version__
            if hasattr(pydrake, "__version__") else ""}


if __name__ == "__main__":
    python_peer.finish(main)
