"""Exact accelerations, computed without any engine: bodies in absolute coordinates, every joint with all its rows.

    M a = f + Gᵀ λ,   G a = γ

G may have any rank: its singular vectors give the admissible accelerations, and the accelerations of rigid bodies are
unique however the reactions divide. States are found by walking along admissible velocities, with a projection onto the
constraints by Newton's method with least norm. Chains of parallelograms (A02) have a closed form, which is used
whatever their size and checked against the general way for short ones.
"""

import math

import numpy as np

from mechanisms import GROUND


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(turn):
    angle = np.linalg.norm(turn)
    k = skew(turn)
    if angle < 1e-9:
        return np.eye(3) + k + k @ k / 2
    return np.eye(3) + math.sin(angle) / angle * k + (1 - math.cos(angle)) / angle**2 * (k @ k)


def turn_of(r):
    """The rotation vector of a matrix, for less than half a turn."""
    s = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]) / 2
    sine, cosine = np.linalg.norm(s), (np.trace(r) - 1) / 2
    return s if sine < 1e-12 else s * (math.atan2(sine, cosine) / sine)


def two_across(axis):
    other = np.eye(3)[np.argmin(np.abs(axis))]
    first = np.cross(axis, other)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


class State:
    """Mass centres p, turns R since the drawing, velocities of the mass centres and angular velocities: world axes."""

    def __init__(self, scene):
        n = len(scene.bodies)
        self.p = np.array([b.com for b in scene.bodies])
        self.R = np.array([np.eye(3)] * n)
        self.v, self.w = np.zeros((n, 3)), np.zeros((n, 3))

    def copy(self):
        other = object.__new__(State)
        other.p, other.R, other.v, other.w = self.p.copy(), self.R.copy(), self.v.copy(), self.w.copy()
        return other

    def displace(self, d):
        d = d.reshape(-1, 6)
        self.p += d[:, :3]
        for i, turn in enumerate(d[:, 3:]):
            self.R[i] = rotation(turn) @ self.R[i]


class Mechanics:
    def __init__(self, scene):
        self.scene = scene
        self.n = len(scene.bodies)
        sizes = [np.linalg.norm(j.at - scene.bodies[k].com) for j in scene.joints for k in (j.a, j.b) if k != GROUND]
        self.length = float(np.median(sizes))  # brings turns and displacements to one scale

    def _point(self, state, body, drawn):
        """Arm from the mass centre, place, velocity, centripetal acceleration of a point of a body."""
        if body == GROUND:
            return np.zeros(3), drawn, np.zeros(3), np.zeros(3)
        r = state.R[body] @ (drawn - self.scene.bodies[body].com)
        w = state.w[body]
        return r, state.p[body] + r, state.v[body] + np.cross(w, r), np.cross(w, np.cross(w, r))

    def _spin(self, state, body):
        return np.zeros(3) if body == GROUND else state.w[body]

    def _frame(self, state, joint):
        return np.eye(3) if joint.a == GROUND else state.R[joint.a]

    def _put(self, rows, body, at, linear, angular):
        if body != GROUND:
            rows[at : at + len(linear), 6 * body : 6 * body + 3] += linear
            rows[at : at + len(linear), 6 * body + 3 : 6 * body + 6] += angular

    def constraints(self, state):
        """phi, G, gamma of all joints."""
        m = 5 * len(self.scene.joints)
        phi, G, gamma = np.zeros(m), np.zeros((m, 6 * self.n)), np.zeros(m)
        for i, j in enumerate(self.scene.joints):
            at = 5 * i
            frame = self._frame(state, j)
            ra, xa, va, ca = self._point(state, j.a, j.at)
            rb, xb, vb, cb = self._point(state, j.b, j.at)
            wa, wb = self._spin(state, j.a), self._spin(state, j.b)
            t = np.array([frame @ x for x in two_across(j.axis)])
            if j.type == "revolute":
                axis_b = (np.eye(3) if j.b == GROUND else state.R[j.b]) @ j.axis
                phi[at : at + 3] = xb - xa
                axis_a = frame @ j.axis
                phi[at + 3 : at + 5] = t @ np.cross(axis_a, axis_b)
                self._put(G, j.b, at, np.eye(3), -skew(rb))
                self._put(G, j.a, at, -np.eye(3), skew(ra))
                gamma[at : at + 3] = ca - cb
                turn_rows, turn_at = t, at + 3
            else:
                d = xb - xa
                u = vb - va - np.cross(wa, d)
                phi[at : at + 2] = t @ d
                self._put(G, j.b, at, t, -t @ skew(rb))
                self._put(G, j.a, at, -t, t @ skew(ra) + t @ skew(d))
                gamma[at : at + 2] = -t @ (cb - ca - np.cross(wa, vb - va)) - np.cross(wa, t) @ u
                turn_rows, turn_at = frame.T, at + 2
                frame_b = np.eye(3) if j.b == GROUND else state.R[j.b]
                phi[at + 2 : at + 5] = turn_of(frame.T @ frame_b)
            zero = np.zeros_like(turn_rows)
            self._put(G, j.b, turn_at, zero, turn_rows)
            self._put(G, j.a, turn_at, zero, -turn_rows)
            gamma[turn_at : at + 5] = -np.cross(wa, turn_rows) @ (wb - wa)
        return phi, G, gamma

    def _scales(self):
        columns = np.tile([1.0] * 3 + [1 / self.length] * 3, self.n)
        rows = []
        for j in self.scene.joints:
            rows += [1.0] * 3 + [self.length] * 2 if j.type == "revolute" else [1.0] * 2 + [self.length] * 3
        return np.array(rows), columns

    def split(self, G):
        """Scaled singular vectors: (function for least-norm solutions of G x = b, basis of G x = 0, rank)."""
        rows, columns = self._scales()
        u, s, vt = np.linalg.svd(rows[:, None] * G * columns, full_matrices=True)
        kept = s > 1e-9 * s[0]
        if np.any(kept):
            rank = int(np.sum(kept))
        else:
            rank = 0
        solve = lambda b: columns * (vt[:rank].T @ ((u[:, :rank].T @ (rows * b)) / s[:rank]))
        return solve, columns[:, None] * vt[rank:].T, rank

    def close(self, state):
        for _ in range(50):
            phi, G, _ = self.constraints(state)
            if not len(phi) or np.abs(phi).max() < 3e-15 * max(1, np.abs(state.p).max()):
                return
            step = self.split(G)[0](-phi)
            if np.abs(step).max() < 1e-15 * max(1, np.abs(state.p).max()):
                return
            state.displace(step)

    def admissible(self, state, twist):
        """The nearest motion that the constraints allow, in scaled components."""
        _, basis, _ = self.split(self.constraints(state)[1])
        _, columns = self._scales()
        z = np.linalg.lstsq(basis / columns[:, None], twist / columns, rcond=None)[0]
        return basis @ z

    def forces(self, state):
        """Mass matrices' blocks and the forces less gyroscopic torques."""
        f = np.zeros((self.n, 6))
        inertias = np.zeros((self.n, 3, 3))
        for i, b in enumerate(self.scene.bodies):
            inertias[i] = state.R[i] @ b.inertia @ state.R[i].T
            f[i, :3] = b.mass * np.array(self.scene.gravity)
            f[i, 3:] = -np.cross(state.w[i], inertias[i] @ state.w[i])
        for s in self.scene.springs:
            ra, xa, _, _ = self._point(state, s.a, s.on_a)
            rb, xb, _, _ = self._point(state, s.b, s.on_b)
            length = np.linalg.norm(xb - xa)
            pull = s.stiffness * (length - s.free_length) * (xb - xa) / length
            for body, arm, force in ((s.a, ra, pull), (s.b, rb, -pull)):
                if body != GROUND:
                    f[body, :3] += force
                    f[body, 3:] += np.cross(arm, force)
        for j in self.scene.joints:
            torque = self.scene.torques.get(j.name, 0)
            if torque:
                axis = self._frame(state, j) @ j.axis
                for body, sign in ((j.a, -1), (j.b, 1)):
                    if body != GROUND:
                        f[body, 3:] += sign * torque * axis
        return inertias, f

    def accelerate(self, state):
        """Accelerations of all bodies (n, 6): mass centre, angular; exact for any rank of G."""
        _, G, gamma = self.constraints(state)
        solve, basis, _ = self.split(G)
        inertias, f = self.forces(state)
        M = np.zeros((6 * self.n, 6 * self.n))
        for i, b in enumerate(self.scene.bodies):
            M[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] = b.mass * np.eye(3)
            M[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] = inertias[i]
        a = solve(gamma)
        small = basis.T @ M @ basis
        for _ in range(3):  # once, and refined
            a = a + basis @ np.linalg.solve(small, basis.T @ (f.ravel() - M @ a))
            a = a + solve(gamma - G @ a)
        return a.reshape(-1, 6)

    def joint_motion(self, state, acceleration=None):
        """q, v (and vdot) of every joint, in the drawing's directions."""
        q, v, a = [], [], []
        for j in self.scene.joints:
            frame = self._frame(state, j)
            frame_b = np.eye(3) if j.b == GROUND else state.R[j.b]
            axis = frame @ j.axis
            wa, wb = self._spin(state, j.a), self._spin(state, j.b)
            acc_a, acc_b = (np.zeros(6) if acceleration is None or k == GROUND else acceleration[k] for k in (j.a, j.b))
            if j.type == "revolute":
                q.append(float(turn_of(frame.T @ frame_b) @ j.axis))
                v.append(float(axis @ (wb - wa)))
                a.append(float(axis @ (acc_b[3:] - acc_a[3:])))
            else:
                ra, xa, va, ca = self._point(state, j.a, j.at)
                rb, xb, vb, cb = self._point(state, j.b, j.at)
                d = xb - xa
                q.append(float(axis @ d))
                v.append(float(axis @ (vb - va - np.cross(wa, d))))
                point_a = acc_a[:3] + np.cross(acc_a[3:], ra) + ca
                point_b = acc_b[:3] + np.cross(acc_b[3:], rb) + cb
                a.append(float(axis @ (point_b - point_a - np.cross(acc_a[3:], d) - np.cross(wa, vb - va))))
        return q, v, a


# ---- states ----------------------------------------------------------------------------------------------------


def parallelogram_state(scene, theta, rate):
    """A02 at a crank angle, clockwise from upright, and its exact accelerations."""
    n = scene.parallelogram_loops
    weight, inertia = ((n + 1) / 2 + n) * 9.81, (n + 1) / 3 + n
    turn_rate = weight / inertia * math.sin(theta)
    state = State(scene)
    acceleration = np.zeros((len(scene.bodies), 6))
    along, across = np.array([math.sin(theta), math.cos(theta), 0]), np.array([math.cos(theta), -math.sin(theta), 0])
    R = rotation(np.array([0, 0, -theta]))
    for i in range(2 * n + 1):
        crank = i <= n
        length = 0.5 if crank else 1.0
        start = np.array([i, 0, 0]) if crank else np.array([i - n - 1 + 0.5, 0, 0])
        state.p[i] = start + length * along
        state.v[i] = length * rate * across
        acceleration[i, :3] = length * (turn_rate * across - rate**2 * along)
        if crank:
            state.R[i] = R
            state.w[i] = (0, 0, -rate)
            acceleration[i, 5] = -turn_rate
    return state, acceleration


def wandered(mechanics, seed, distance=0.4, speed=1.0):
    """A state away from the drawing, moving: the same on every machine, since a projection has no sign to choose."""
    rng = np.random.default_rng(seed)
    state = State(mechanics.scene)
    direction = rng.uniform(-1, 1, 6 * mechanics.n)
    steps = 8
    for _ in range(steps):
        step = mechanics.admissible(state, direction)
        largest = largest_joint_speed(mechanics, state, step)
        state.displace(step * (distance / steps / largest))
        mechanics.close(state)
        direction = step
    mechanics.close(state)
    twist = mechanics.admissible(state, rng.uniform(-1, 1, 6 * mechanics.n))
    twist *= speed / largest_joint_speed(mechanics, state, twist)
    state.v, state.w = twist.reshape(-1, 6)[:, :3].copy(), twist.reshape(-1, 6)[:, 3:].copy()
    return state


def largest_joint_speed(mechanics, state, twist):
    moving = state.copy()
    moving.v, moving.w = twist.reshape(-1, 6)[:, :3], twist.reshape(-1, 6)[:, 3:]
    return max(abs(x) for x in mechanics.joint_motion(moving)[1])


def states_of(scene, count=4):
    """[(state, accelerations)] at which engines are timed and checked."""
    if scene.parallelogram_loops:
        poses = [(0.3, 1.2), (0.9, -0.7), (-0.5, 1.6), (2.2, 0.4)][:count]
        return [parallelogram_state(scene, *pose) for pose in poses]
    mechanics = Mechanics(scene)
    size = {"scissor_10": 0.1, "andrews": 0.4}.get(scene.name, 0.4)
    states = [wandered(mechanics, 1 + k, size, 1.0) for k in range(count)]
    return [(s, mechanics.accelerate(s)) for s in states]


def quaternion(r):
    """w, x, y, z with w >= 0."""
    turn = turn_of(r)
    angle = np.linalg.norm(turn)
    axis = turn / angle if angle > 0 else turn
    return [math.cos(angle / 2), *(math.sin(angle / 2) * axis)]


def as_json(scene, states):
    """The neutral form that every program reads; free bodies are placed by a point that is their mass centre as drawn."""
    order, cut = scene.tree()
    mechanics = Mechanics(scene)
    listed = []
    for state, acceleration in states:
        q, v, a = mechanics.joint_motion(state, acceleration)
        free = [{"body": b, "place": state.p[b].tolist(), "quaternion": [float(x) for x in quaternion(state.R[b])],
                 "velocity": state.v[b].tolist(), "spin": state.w[b].tolist()} for b, j in order if j is None]
        listed.append({"q": q, "v": v, "a": a, "free": free})
    return {
        "name": scene.name, "title": scene.title, "gravity": list(scene.gravity), "watched": scene.watched,
        "bodies": [{"name": b.name, "mass": b.mass, "com": b.com.tolist(), "inertia": b.inertia.ravel().tolist()}
                   for b in scene.bodies],
        "joints": [{"name": j.name, "type": j.type, "a": j.a, "b": j.b, "at": j.at.tolist(), "axis": j.axis.tolist(),
                    "torque": scene.torques.get(j.name, 0), "start_speed": scene.speeds.get(j.name, 0)}
                   for j in scene.joints],
        "springs": [{"a": s.a, "b": s.b, "on_a": s.on_a.tolist(), "on_b": s.on_b.tolist(), "stiffness": s.stiffness,
                     "free_length": s.free_length} for s in scene.springs],
        "tree": [[b, -1 if j is None else j] for b, j in order], "cut": cut, "states": listed}


def self_test(scenes):
    """Published and closed-form values against the general computation."""
    by_name = {s.name: s for s in scenes}
    m = Mechanics(by_name["andrews"])
    a = m.joint_motion(State(m.scene), m.accelerate(State(m.scene)))[2]
    at = {j.name: i for i, j in enumerate(m.scene.joints)}
    checks = [("andrews beta", a[at["beta"]], 14222.4439199541), ("andrews Theta", a[at["Theta"]], -10666.8329399655)]
    m = Mechanics(by_name["bricard"])
    checks.append(("bricard J1", abs(m.joint_motion(State(m.scene), m.accelerate(State(m.scene)))[2][0]), 1.958083832335))
    for name in ("a02_n1", "a02_n10"):
        m = Mechanics(by_name[name])
        state, exact = parallelogram_state(m.scene, 0.9, -0.7)
        checks.append((name, float(np.abs(m.accelerate(state) - exact).max()) + 1, 1.0))
    return [(what, got, want, abs(got - want) / abs(want)) for what, got, want in checks]


if __name__ == "__main__":
    import mechanisms

    every = mechanisms.all_scenes()
    for what, got, want, error in self_test(every):
        print(f"{what:20} {got:.13g} {want:.13g} {error:.1e}")
    for scene in every:
        if scene.parallelogram_loops > 10:
            continue
        m = Mechanics(scene)
        _, G, _ = m.constraints(State(scene))
        rank = m.split(G)[2]
        s, acc = states_of(scene, 2)[1]
        phi, G, gamma = m.constraints(s)
        rank2 = m.split(G)[2]
        off = np.abs(phi).max() if len(phi) else 0
        slip = np.abs(G @ np.hstack([s.v, s.w]).ravel()).max()
        print(f"{scene.name:14} bodies {m.n} rows {len(G)} rank {rank} {rank2} mobility {6 * m.n - rank} phi {off:.1e} Gv {slip:.1e}"
              f" cut {[scene.joints[i].name for i in scene.tree()[1]][:6]} amax {np.abs(acc).max():.3g}")
