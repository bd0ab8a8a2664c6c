#!/usr/bin/env python3
"""Compares what Ferrers and MuJoCo make of the same MJCF files: masses, poses, mass matrix, forces, constraints.

    python3 -m venv venv && venv/bin/pip install mujoco numpy
    venv/bin/python compare_mujoco.py --probe build/test/bin/model_probe FILE.xml ...

At random states (the reference configuration among them) it compares, with the transformation between both choices of
velocities (MuJoCo turns balls and free bodies in their own axes, Ferrers in those of the body before):

  mass, mass centre and inertia of every body; poses of all bodies
  M          with rotor inertias
  h - tau    Coriolis, gravity, springs, dampers, compensated weight
  G          by the space that the rows span: constraint by constraint
  phi = 0    at the reference configuration, where MuJoCo's constraints hold

Ferrers takes the joints of the fewest freedoms for its tree: where a constraint holds more than the joints beside it,
these have no coordinates. Such a file is compared without its constraints, which is told. The last line says the greatest difference,
each relative to the greatest entry of its kind; the exit code is 1 beyond --tolerance.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import mujoco
import numpy as np

HINGE, SLIDE, BALL, FREE = (int(kind) for kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE,
                                                   mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_FREE))


def allowed(name):
    """As Ferrers makes names out of those of the file."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return "_" + name if name[:1].isdigit() else name


def matrix(quaternion):
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, quaternion)
    return out.reshape(3, 3)


class Names:
    """Names of bodies and joints in Ferrers, in MuJoCo's order."""

    def __init__(self, model):
        self.bodies, originals, taken = ["ground"], ["world"], {"ground"}
        for i in range(1, model.nbody):
            original = model.body(i).name or originals[model.body_parentid[i]] + "_body"
            originals.append(original)
            self.bodies.append(self.unique(original, taken))
        taken = set()
        self.joints = []
        for j in range(model.njnt):
            original = model.joint(j).name or originals[model.jnt_bodyid[j]] + "_joint"
            self.joints.append(self.unique(original, taken))

    @staticmethod
    def unique(original, taken):
        wanted = name = allowed(original)
        number = 2
        while name in taken:
            name, number = f"{wanted}_{number}", number + 1
        taken.add(name)
        return name


def random_state(model, rng, reference):
    q, v = np.copy(model.qpos0), np.zeros(model.nv)
    if reference:
        return q, v
    v = rng.normal(size=model.nv)
    for j in range(model.njnt):
        at, kind = model.jnt_qposadr[j], model.jnt_type[j]
        if kind in (HINGE, SLIDE):
            q[at] += rng.uniform(-1, 1) * (1.5 if kind == HINGE else 0.2)
        else:
            turn = rng.normal(size=4)
            if kind == FREE:
                q[at:at + 3] += rng.normal(size=3)
            q[at + (3 if kind == FREE else 0):][:4] = turn / np.linalg.norm(turn)
    return q, v


def ferrers_state(model, names, q, v):
    positions, velocities = {}, {}
    for j, name in enumerate(names.joints):
        at, dof, kind = model.jnt_qposadr[j], model.jnt_dofadr[j], model.jnt_type[j]
        if kind in (HINGE, SLIDE):
            positions[name], velocities[name] = [q[at]], [v[dof]]
        elif kind == BALL:
            positions[name] = list(q[at:at + 4])
            velocities[name] = list(matrix(q[at:at + 4]) @ v[dof:dof + 3])
        else:
            positions[name] = list(q[at:at + 7])
            velocities[name] = list(matrix(q[at + 3:at + 7]) @ v[dof + 3:dof + 6]) + list(v[dof:dof + 3])
    return {"positions": positions, "velocities": velocities}


def transformation(model, names, columns, q, v):
    """T and its bias c in v_ferrers = T v_mujoco, vdot_ferrers = T vdot_mujoco + c. c is zero: the rate of R w is R wdot."""
    index = {name: i for i, name in enumerate(columns)}
    T = np.zeros((len(columns), model.nv))
    for j, name in enumerate(names.joints):
        at, dof, kind = model.jnt_qposadr[j], model.jnt_dofadr[j], model.jnt_type[j]
        if kind in (HINGE, SLIDE):
            T[index[name], dof] = 1
            continue
        R = matrix(q[at + (3 if kind == FREE else 0):][:4])
        for i, axis in enumerate("xyz"):
            T[index[f"{name}.omega_{axis}"], dof + (3 if kind == FREE else 0):][:3] = R[i]
            if kind == FREE:
                T[index[f"{name}.v_{axis}"], dof + i] = 1
    return T


class Differences:
    def __init__(self):
        self.greatest = {}

    def add(self, kind, ours, theirs, least=1e-6):
        """Relative to the greatest entry, or to `least` where that is greater."""
        ours, theirs = np.asarray(ours, float), np.asarray(theirs, float)
        scale = max(np.max(np.abs(theirs), initial=0), least)
        difference = float(np.max(np.abs(ours - theirs), initial=0) / scale)
        self.greatest[kind] = max(self.greatest.get(kind, 0), difference)


def compare_bodies(model, names, told, out):
    mass = np.array([told["bodies"][n]["mass"] for n in names.bodies[1:]])
    out.add("mass", mass, model.body_mass[1:], 1e-12)
    for i, name in enumerate(names.bodies[1:], 1):
        ours = told["bodies"][name]
        if model.body_mass[i] > 0:
            out.add("mass centre", ours["com"], model.body_ipos[i])
        R = matrix(model.body_iquat[i])
        out.add("inertia", ours["inertia"], R @ np.diag(model.body_inertia[i]) @ R.T)


def equality_rows(model, data):
    """Rows of the active equality constraints, constraint by constraint."""
    mujoco.mj_makeConstraint(model, data)
    J = np.zeros((data.nefc, model.nv))
    if data.nefc:
        J = data.efc_J.reshape(data.nefc, model.nv) if not mujoco.mj_isSparse(model) else dense(model, data)
    kinds = np.asarray(data.efc_type[:data.nefc])
    rows = kinds == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    return J[rows], np.asarray(data.efc_pos[:data.nefc])[rows]


def dense(model, data):
    J = np.zeros((data.nefc, model.nv))
    mujoco.mju_sparse2dense(J, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    return J


def same_space(ours, theirs):
    """How far the rows of one are from the span of the others', relative to their length."""
    worst = 0
    for a, b in ((ours, theirs), (theirs, ours)):
        if len(a) == 0 or np.max(np.abs(a), initial=0) == 0:
            continue
        rest = a.T - (b.T @ np.linalg.lstsq(b.T, a.T, rcond=1e-11)[0] if len(b) else 0)
        worst = max(worst, float(np.max(np.abs(rest)) / np.max(np.abs(a))))
    return worst


def mass_matrix(model, data):
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M) if mujoco.__version__ >= "3.5" else mujoco.mj_fullM(model, M, data.qM)
    return M


def changed_copy(path, folder, change):
    """A changed copy among links to the files beside the original."""
    source = pathlib.Path(path).resolve()
    for other in source.parent.iterdir():
        (folder / other.name).symlink_to(other)
    copy = folder / source.name
    copy.unlink()
    tree = xml.etree.ElementTree.parse(source)
    change(tree.getroot())
    tree.write(copy)
    return str(copy)


def switch_constraints_off(root):
    option = xml.etree.ElementTree.SubElement(root, "option")
    xml.etree.ElementTree.SubElement(option, "flag", {"equality": "disable"})


def drop_meshes(root):
    """Geoms that draw a mesh, and the meshes: where bodies have their <inertial>, nothing else depends on them."""
    for parent in list(root.iter()):
        for child in list(parent):
            if (child.tag in ("mesh", "texture", "material") and parent.tag == "asset") or (
                    child.tag == "geom" and "mesh" in child.attrib):
                parent.remove(child)
            child.attrib.pop("material", None)


def compare(path, probe, states, seed):
    model = mujoco.MjModel.from_xml_path(path)
    model.opt.disableflags |= (mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT |
                               mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS | mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    data, names, rng = mujoco.MjData(model), Names(model), np.random.default_rng(seed)
    given = [random_state(model, rng, reference=i == 0) for i in range(states)]
    asked = json.dumps({"states": [ferrers_state(model, names, q, v) for q, v in given]})
    run = subprocess.run([probe, path], input=asked, capture_output=True, text=True, timeout=300, check=False)
    if run.returncode != 0:
        raise RuntimeError(run.stderr.strip())
    told = json.loads(run.stdout)
    out = Differences()
    known = all(body["has_mass"] for name, body in told["bodies"].items() if name != "ground")
    if known:
        compare_bodies(model, names, told, out)
    for number, ((q, v), ours) in enumerate(zip(given, told["states"])):
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)
        extent = max(1e-6, np.max(np.abs(data.xpos), initial=0), np.max(np.abs(data.xipos), initial=0))
        for i, name in enumerate(names.bodies[1:], 1):
            out.add("position", ours["bodies"][name]["position"], data.xpos[i], extent)
            out.add("rotation", ours["bodies"][name]["rotation"], data.xmat[i].reshape(3, 3))
        if not known:  # by meshes, which Ferrers does not load
            continue
        T = transformation(model, names, told["velocities"], q, v)
        M = mass_matrix(model, data)
        out.add("M", T.T @ np.array(ours["M"]).reshape(model.nv, model.nv) @ T, M)
        force = np.array(ours["h"]) - np.array(ours["tau"])
        weight = max(1e-6, 9.81 * np.max(np.abs(M), initial=0))
        out.add("h - tau", T.T @ force, data.qfrc_bias - data.qfrc_passive, weight)
        J, phi = equality_rows(model, data)
        G = np.array(ours["G"]).reshape(-1, model.nv) @ T if len(ours["G"]) else np.zeros((0, model.nv))
        if number == 0:  # off the constraints a row's gradient is a matter of taste
            out.greatest["G"] = max(out.greatest.get("G", 0), same_space(G, J))
            out.add("phi", ours["phi"], np.zeros(len(ours["phi"])), extent)
    return out.greatest


def compare_with_fallback(path, probe, states, seed, note=None):
    """Without the constraints where Ferrers chose another tree; `note`, a list, then gets a word about it."""
    try:
        return compare(path, probe, states, seed)
    except RuntimeError as error:
        if "is cut" not in str(error):
            raise
    if note is not None:
        note.append(" (without constraints)")
    with tempfile.TemporaryDirectory() as folder:
        copy = changed_copy(path, pathlib.Path(folder), switch_constraints_off)
        return compare(copy, probe, states, seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+")
    parser.add_argument("--probe", default="build/test/bin/model_probe")
    parser.add_argument("--states", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tolerance", type=float, default=1e-9)
    parser.add_argument("--drop-meshes", action="store_true", help="for files whose meshes are missing")
    options = parser.parse_args()
    worst, failed = 0.0, 0
    meshless = tempfile.TemporaryDirectory()
    for number, path in enumerate(options.files):
        note = []
        if options.drop_meshes:
            folder = pathlib.Path(meshless.name) / str(number)
            folder.mkdir()
            path = changed_copy(path, folder, drop_meshes)
        try:
            found = compare_with_fallback(path, options.probe, options.states, options.seed, note)
        except Exception as error:  # a file that one of the two refuses is told, not compared
            print(f"{path}: not compared: {error}")
            failed += 1
            continue
        worst = max(worst, *found.values())
        print(f"{path}{''.join(note)}: " + ", ".join(f"{kind} {value:.1e}" for kind, value in found.items()))
    print(f"{len(options.files) - failed} files, greatest difference {worst:.1e}; {failed} not compared")
    return 1 if worst > options.tolerance or failed else 0


if __name__ == "__main__":
    sys.exit(main())
