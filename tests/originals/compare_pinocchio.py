#!/usr/bin/env python3
"""Compares what Ferrers and Pinocchio make of URDF files: masses, inertias, poses, M and bias forces.

    python3 compare_pinocchio.py build/test/bin/model_probe FILE.urdf...

At random states (the seed is the file's place in the list) the poses of all links, the mass matrix and the bias forces
with gravity must agree within 1e-9 of their size, and so must masses, mass centres and inertias of what each joint
carries. Needs numpy and pin (pip install pin). Floating and planar joints inside a file stay at zero. Exit codes: 0 all
agree; 1 some do not, or none was compared; 64 wrong use.
"""

import json
import re
import subprocess
import sys

import numpy as np
import pinocchio as pin

TOLERANCE = 1e-9
STATES = 3


def ferrers_name(name):
    """As the reader renames what the native format does not allow."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", name)
    name = "_" + name if name[:1].isdigit() else name
    return name + "_" if name in ("ground", "t", "energy") else name


def one_coordinate(model, joint):
    return model.joints[joint].nv == 1


def random_state(model, random):
    """q and v of Pinocchio, and the same by joint."""
    q, v = pin.neutral(model), np.zeros(model.nv)
    positions, velocities = {}, {}
    for joint in range(1, model.njoints):
        if not one_coordinate(model, joint):
            continue
        one = model.joints[joint]
        angle, rate = random.uniform(-1.5, 1.5), random.uniform(-2, 2)
        q[one.idx_q : one.idx_q + one.nq] = [angle] if one.nq == 1 else [np.cos(angle), np.sin(angle)]
        v[one.idx_v] = rate
        positions[ferrers_name(model.names[joint])] = [angle]
        velocities[ferrers_name(model.names[joint])] = [rate]
    return q, v, {"positions": positions, "velocities": velocities}


def probe(program, path, states):
    command = [program, path, "--base", "fixed", "--ignore", "armature,springs,damping", "--revolute-rows", "keep"]
    run = subprocess.run(command, input=json.dumps({"states": states}), capture_output=True, text=True, timeout=300)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip().splitlines()[0] if run.stderr.strip() else f"exit code {run.returncode}")
    return json.loads(run.stdout)


def difference(ours, theirs):
    """The largest difference, by the size of what is compared but at least 1."""
    ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
    if theirs.size == 0:
        return 0.0
    return float(np.abs(ours - theirs).max() / max(1.0, np.abs(theirs).max()))


def body_frames(model):
    return [frame for frame in model.frames if frame.type == pin.FrameType.BODY and frame.name != "universe"]


def carried(model, bodies):
    """Mass, first moment and inertia about the joint's origin of what each joint carries, of our bodies."""
    total = [pin.Inertia.Zero() for _ in range(model.njoints)]
    for frame in body_frames(model):
        body = bodies.get(ferrers_name(frame.name))
        if body is None:
            continue
        inertia = pin.Inertia(body["mass"], np.array(body["com"]), np.array(body["inertia"]))
        total[frame.parentJoint] = total[frame.parentJoint] + frame.placement.act(inertia)
    return total


def compare_inertias(model, bodies):
    worst = 0.0
    for joint, ours in enumerate(carried(model, bodies)):
        worst = max(worst, difference(ours.matrix(), model.inertias[joint].matrix()))
    return worst


def compare_state(model, data, q, v, result, names):
    pin.forwardKinematics(model, data, q)
    pin.updateFramePlacements(model, data)
    poses = 0.0
    for frame in body_frames(model):
        ours = result["bodies"].get(ferrers_name(frame.name))
        if ours is None:
            continue
        theirs = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
        poses = max(poses, difference(ours["position"], theirs.translation), difference(ours["rotation"], theirs.rotation))
    joints = [j for j in range(1, model.njoints) if one_coordinate(model, j)]
    theirs_at = [model.joints[j].idx_v for j in joints]
    ours_at = [names.index(ferrers_name(model.names[j])) for j in joints]
    M = pin.crba(model, data, q)
    M = np.triu(M) + np.triu(M, 1).T
    bias = pin.nonLinearEffects(model, data, q, v)
    ours_M = np.asarray(result["M"], float).reshape(len(names), len(names))
    ours_bias = np.asarray(result["h"], float) - np.asarray(result["tau"], float)
    return (poses, difference(ours_M[np.ix_(ours_at, ours_at)], M[np.ix_(theirs_at, theirs_at)]),
            difference(ours_bias[ours_at], bias[theirs_at]))


def compare(program, path, seed):
    """The largest differences of inertias, poses, M, bias forces."""
    model = pin.buildModelFromUrdf(path)
    data = model.createData()
    random = np.random.default_rng(seed)
    states = [random_state(model, random) for _ in range(STATES)]
    ours = probe(program, path, [state for _, _, state in states])
    worst = np.zeros(3)
    for (q, v, _), result in zip(states, ours["states"]):
        worst = np.maximum(worst, compare_state(model, data, q, v, result, ours["velocities"]))
    return (compare_inertias(model, ours["bodies"]), *worst)


def main():
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 64
    failed = compared = 0
    print("| file | inertias | poses | M | bias forces | |\n|---|---|---|---|---|---|")
    for seed, path in enumerate(sys.argv[2:]):
        name = "/".join(path.split("/")[-3:])
        try:
            worst = compare(sys.argv[1], path, seed)
        except (RuntimeError, ValueError, subprocess.TimeoutExpired) as error:
            print(f"| {name} | | | | | not compared: {str(error).splitlines()[0]} |")
            continue
        agrees = all(one <= TOLERANCE for one in worst)
        failed += not agrees
        compared += 1
        print(f"| {name} | " + " | ".join(f"{one:.1e}" for one in worst) + f" | {'agrees' if agrees else 'DIFFERS'} |")
    return 1 if failed or compared == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
