"""The mechanisms that every engine is measured on, each defined once and without a word of any engine.

A scene is drawn: mass centres, inertias, joint points and axes in world coordinates, loops closed, every joint
coordinate zero. A joint coordinate is the motion of the second body relative to the first. Joints are revolute or
prismatic; a body that the tree reaches by no joint floats (the humanoid's pelvis). `cut` names the joints that close
loops for engines that need a spanning tree: the shallowest tree, unless a scene says otherwise.
"""

import math
from dataclasses import dataclass, field

import numpy as np

GROUND = -1


@dataclass
class Body:
    name: str
    mass: float
    com: np.ndarray
    inertia: np.ndarray  # about the mass centre, world axes


@dataclass
class Joint:
    name: str
    type: str  # revolute, prismatic
    a: int
    b: int
    at: np.ndarray
    axis: np.ndarray


@dataclass
class Spring:
    a: int
    b: int
    on_a: np.ndarray
    on_b: np.ndarray
    stiffness: float
    free_length: float


@dataclass
class Scene:
    name: str
    title: str
    gravity: tuple
    bodies: list = field(default_factory=list)
    joints: list = field(default_factory=list)
    springs: list = field(default_factory=list)
    torques: dict = field(default_factory=dict)  # joint -> constant effort
    speeds: dict = field(default_factory=dict)  # joint -> velocity at the start of a simulation
    cut: list = field(default_factory=list)
    watched: str = ""  # the joint whose final coordinate judges a simulation
    parallelogram_loops: int = 0  # of A02: its motion is known in closed form

    def body(self, name, mass, com, inertia):
        self.bodies.append(Body(name, float(mass), np.array(com, float), np.array(inertia, float)))
        return len(self.bodies) - 1

    def rod(self, name, start, end, mass, radius=0.0):
        """A uniform cylinder; without a radius, a thin rod."""
        start, end = np.array(start, float), np.array(end, float)
        along = end - start
        length = np.linalg.norm(along)
        u = along / length
        across = mass * (length**2 / 12 + radius**2 / 4)
        inertia = across * (np.eye(3) - np.outer(u, u)) + mass * radius**2 / 2 * np.outer(u, u)
        return self.body(name, mass, (start + end) / 2, inertia)

    def box(self, name, com, size, mass):
        x, y, z = size
        return self.body(name, mass, com, np.diag([y * y + z * z, x * x + z * z, x * x + y * y]) * mass / 12)

    def joint(self, name, type_, a, b, at, axis):
        axis = np.array(axis, float)
        self.joints.append(Joint(name, type_, a, b, np.array(at, float), axis / np.linalg.norm(axis)))

    def revolute(self, name, a, b, at, axis=(0, 0, 1)):
        self.joint(name, "revolute", a, b, at, axis)

    def prismatic(self, name, a, b, at, axis):
        self.joint(name, "prismatic", a, b, at, axis)

    def tree(self):
        """Bodies in order from ground outwards as (body, joint index or None); and the indices of the cut joints."""
        touching = {b: [] for b in range(-1, len(self.bodies))}
        for i, j in enumerate(self.joints):
            if j.name not in self.cut:
                touching[j.a].append(i)
                touching[j.b].append(i)
        reached, order, used = {GROUND}, [], set()

        def walk(queue):
            while queue:
                at = queue.pop(0)
                for i in touching[at]:
                    j = self.joints[i]
                    far = j.b if j.a == at else j.a
                    if far not in reached:
                        reached.add(far)
                        used.add(i)
                        order.append((far, i))
                        queue.append(far)

        walk([GROUND])
        for b in range(len(self.bodies)):
            if b not in reached:
                reached.add(b)
                order.append((b, None))
                walk([b])
        return depth_first(order, self.joints), [i for i in range(len(self.joints)) if i not in used]


def depth_first(order, joints):
    """The same tree with every body followed by its own descendants, as some engines need it."""
    children, roots = {}, []
    for body, joint in order:
        if joint is None:
            roots.append((body, joint))
        else:
            j = joints[joint]
            children.setdefault(j.a if j.b == body else j.b, []).append((body, joint))
    listed, waiting = [], list(reversed(children.get(GROUND, []) + roots))
    while waiting:
        entry = waiting.pop()
        listed.append(entry)
        waiting += reversed(children.get(entry[0], []))
    return listed


# ---- planar mechanisms of spatial joints -----------------------------------------------------------------------


def four_bar():
    """Four bars of no special lengths, 1 kg/m."""
    s = Scene("four_bar", "four-bar", (0, -9.81, 0), watched="A")
    p = [np.array(x, float) for x in ((0, 0, 0), (0.3, 0.9, 0), (2, 1.5, 0), (1.8, 0, 0))]
    rods = [s.rod(f"bar{i + 1}", p[i], p[i + 1], np.linalg.norm(p[i + 1] - p[i])) for i in range(3)]
    s.revolute("A", GROUND, rods[0], p[0])
    s.revolute("B", rods[0], rods[1], p[1])
    s.revolute("C", rods[1], rods[2], p[2])
    s.revolute("D", GROUND, rods[2], p[3])
    return s


def n_four_bar(n):
    """A02: cranks drawn upright, tips moving to the right with 1 m/s; axes along -z, so that angles count clockwise."""
    s = Scene(f"a02_n{n}", f"A02 N={n}", (0, -9.81, 0), watched="pivot0", parallelogram_loops=n)
    cranks = [s.rod(f"crank{i}", (i, 0, 0), (i, 1, 0), 1) for i in range(n + 1)]
    couplers = [s.rod(f"coupler{i}", (i, 1, 0), (i + 1, 1, 0), 1) for i in range(n)]
    axis = (0, 0, -1)
    for i in range(n + 1):
        s.revolute(f"pivot{i}", GROUND, cranks[i], (i, 0, 0), axis)
    for i in range(n):
        s.revolute(f"left{i}", cranks[i], couplers[i], (i, 1, 0), axis)
        s.revolute(f"right{i}", couplers[i], cranks[i + 1], (i + 1, 1, 0), axis)
    s.speeds = {f"pivot{i}": 1.0 for i in range(n + 1)}
    for i in range(n):
        s.speeds[f"left{i}"], s.speeds[f"right{i}"] = -1.0, 1.0
    return s


def three_cranks():
    """A platform on three parallel cranks; as in examples/three-cranks."""
    s = Scene("three_cranks", "3 cranks", (0, -9.81, 0), watched="low1")
    c, t, gap = math.cos(0.7), math.sin(0.7), 1.3
    cranks = [s.rod(f"crank{i + 1}", (i * gap, 0, 0), (i * gap + c, t, 0), 2) for i in range(3)]
    platform = s.box("platform", (gap + c, t, 0), (2 * gap, 0.05, 0.05), 6)
    for i in range(3):
        s.revolute(f"low{i + 1}", GROUND, cranks[i], (i * gap, 0, 0))
        s.revolute(f"high{i + 1}", cranks[i], platform, (i * gap + c, t, 0))
    return s


def andrews():
    """A03, Andrews' squeezer: parameters and initial angles of the published benchmark; flat bodies."""
    s = Scene("andrews", "Andrews A03", (0, 0, 0), watched="beta")
    beta, gamma, phi = -0.0617138900142764496, 0.455279819163070380, 0.222668390165885885
    delta, omega, epsilon = 0.487364979543842550, -0.222668390165885885, 1.23054744454982120
    xa, ya, xb, yb = -0.06934, -0.00227, -0.03635, 0.03273

    def ray(angle, length):
        return np.array([math.cos(angle), math.sin(angle), 0]) * length

    def left(angle, length):
        return np.array([-math.sin(angle), math.cos(angle), 0]) * length

    a, b = np.array([xa, ya, 0]), np.array([xb, yb, 0])
    f = ray(beta, 0.007)
    e = f - ray(beta, 0.028)  # Theta starts at zero
    g = a + ray(delta, 0.04)
    h = a - left(epsilon, 0.04)
    centres = [
        ray(beta, 0.00092), f - ray(beta, 0.0115), b + ray(gamma, 0.01043) - left(gamma, 0.01874),
        g - left(delta + phi, 0.02 - 0.01421), a + ray(delta, 0.02308) + left(delta, 0.00916),
        h + ray(epsilon + omega, 0.02 - 0.01421), a - ray(epsilon, 0.00449) - left(epsilon, 0.01228)]
    masses = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498]
    moments = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5]
    k = [s.body(f"K{i + 1}", masses[i], centres[i], np.diag([0.5, 0.5, 1]) * moments[i]) for i in range(7)]
    s.revolute("beta", GROUND, k[0], (0, 0, 0))
    s.revolute("gamma", GROUND, k[2], b)
    s.revolute("delta", GROUND, k[4], a)
    s.revolute("epsilon", GROUND, k[6], a)
    s.revolute("Theta", k[0], k[1], f)
    s.revolute("Phi", k[4], k[3], g)
    s.revolute("Omega", k[6], k[5], h)
    for end in (3, 4, 6):
        s.revolute(f"E{end}", k[1], k[end - 1], e)
    s.springs.append(Spring(GROUND, k[2], np.array([0.014, 0.072, 0]), b + ray(gamma, 0.02) - left(gamma, 0.018), 4530.0, 0.07785))
    s.torques = {"beta": 0.033}
    s.cut = ["E3", "E4", "E6"]
    return s


def scissor_lift(stages=10):
    """Crossed 2 m bars, a roller below and one above, a platform; as in examples/scissor-lift."""
    s = Scene(f"scissor_{stages}", f"scissor lift, {stages} stages", (0, -9.81, 0), watched="track")
    w, h = 2 * math.cos(0.5), 2 * math.sin(0.5)
    up = [s.rod(f"up{i + 1}", (0, i * h, 0), (w, (i + 1) * h, 0), 8) for i in range(stages)]
    down = [s.rod(f"down{i + 1}", (w, i * h, 0), (0, (i + 1) * h, 0), 8) for i in range(stages)]
    top = stages * h
    platform = s.box("platform", (1, top, 0), (2, 0.06, 2), 60)
    low = s.box("low_roller", (w, 0, 0), (0.05, 0.05, 0.05), 1)
    high = s.box("high_roller", (w, top, 0), (0.05, 0.05, 0.05), 1)
    s.revolute("base", GROUND, up[0], (0, 0, 0))
    s.prismatic("track", GROUND, low, (w, 0, 0), (1, 0, 0))
    s.revolute("low_pin", low, down[0], (w, 0, 0))
    for i in range(stages):
        s.revolute(f"middle{i + 1}", up[i], down[i], (w / 2, (i + 0.5) * h, 0))
    for i in range(stages - 1):
        s.revolute(f"left{i + 1}", down[i], up[i + 1], (0, (i + 1) * h, 0))
        s.revolute(f"right{i + 1}", up[i], down[i + 1], (w, (i + 1) * h, 0))
    s.revolute("top_pin", down[-1], platform, (0, top, 0))
    s.revolute("high_pin", up[-1], high, (w, top, 0))
    s.prismatic("rail", platform, high, (w, top, 0), (1, 0, 0))
    s.cut = ["low_pin", "high_pin"] + [f"middle{i + 1}" for i in range(1, stages)]
    return s


# ---- spatial mechanisms ----------------------------------------------------------------------------------------


def bricard():
    """A04: five rods of 1 m along the edges of a cube, square section of 0.1 m; the ground is the sixth."""
    s = Scene("bricard", "Bricard A04", (0, -9.81, 0), watched="J1")
    p = [np.array(x, float) for x in ((0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1))]
    axes = ["y", "z", "x", "y", "z", "x"]
    unit = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    rods = []
    for i in range(5):
        size = np.where(np.abs(p[i + 1] - p[i]) > 0.5, 1.0, 0.1)
        rods.append(s.box(f"rod{i + 1}", (p[i] + p[i + 1]) / 2, size, 1))
    ends = [GROUND, *rods, GROUND]
    for i in range(6):
        s.revolute(f"J{i + 1}", ends[i], ends[i + 1], p[i], unit[axes[i]])
    return s


def sarrus():
    """Two legs of three parallel hinges, in planes at right angles, carry a platform; as in examples/sarrus."""
    s = Scene("sarrus", "Sarrus", (0, 0, -9.81), watched="A1")
    c, t = math.cos(0.8), math.sin(0.8)
    platform_com = (0, 0, 2 * t)
    legs = []
    for name, out, axis in (("1", np.array([1.0, 0, 0]), (0, 1, 0)), ("2", np.array([0, 1.0, 0]), (1, 0, 0))):
        up = np.array([0, 0, 1.0])
        a, b, d = out, out * (1 + c) + up * t, out + up * 2 * t
        low, high = s.rod("low" + name, a, b, 2, 0.02), s.rod("high" + name, b, d, 2, 0.02)
        legs.append((name, low, high, a, b, d, axis))
    platform = s.box("platform", platform_com, (2, 2, 0.05), 5)
    for name, low, high, a, b, d, axis in legs:
        s.revolute("A" + name, GROUND, low, a, axis)
        s.revolute("B" + name, low, high, b, axis)
        s.revolute("C" + name, high, platform, d, axis)
    return s


def delta_robot():
    """Three arms and forearms; each forearm is a parallelogram of four hinges between two cross bars, all hinges."""
    s = Scene("delta", "delta robot", (0, 0, -9.81), watched="shoulder1")
    base_radius, platform_radius, arm, half = 0.2, 0.08, 0.3, 0.06
    dip = 0.3  # rad, of the arms below the horizontal
    elbow_radius = base_radius + arm * math.cos(dip)
    elbow_z = -arm * math.sin(dip)
    reach = elbow_radius - platform_radius
    platform_z = elbow_z - math.sqrt(0.7**2 - reach**2)
    platform = s.rod("platform", (0, 0, platform_z - 0.01), (0, 0, platform_z + 0.01), 0.5, 0.1)
    for i in range(3):
        angle = 2 * math.pi * i / 3
        out = np.array([math.cos(angle), math.sin(angle), 0])
        across = np.array([-math.sin(angle), math.cos(angle), 0])
        up = np.array([0, 0, 1.0])
        shoulder, elbow = out * base_radius, out * elbow_radius + up * elbow_z
        wrist = out * platform_radius + up * platform_z
        down = (wrist - elbow) / np.linalg.norm(wrist - elbow)
        normal = np.cross(down, across)  # of the parallelogram
        n = str(i + 1)
        upper = s.rod("arm" + n, shoulder, elbow, 0.6, 0.015)
        top = s.rod("top" + n, elbow - across * half, elbow + across * half, 0.08, 0.008)
        left = s.rod("left" + n, elbow - across * half, wrist - across * half, 0.12, 0.006)
        right = s.rod("right" + n, elbow + across * half, wrist + across * half, 0.12, 0.006)
        low = s.rod("low" + n, wrist - across * half, wrist + across * half, 0.08, 0.008)
        s.revolute("shoulder" + n, GROUND, upper, shoulder, across)
        s.revolute("elbow" + n, upper, top, elbow, across)
        s.revolute("top_left" + n, top, left, elbow - across * half, normal)
        s.revolute("top_right" + n, top, right, elbow + across * half, normal)
        s.revolute("low_left" + n, left, low, wrist - across * half, normal)
        s.revolute("low_right" + n, right, low, wrist + across * half, normal)
        s.revolute("wrist" + n, low, platform, wrist, across)
    s.cut = ["low_right1", "low_right2", "low_right3", "wrist2", "wrist3"]
    return s


# ---- open trees ------------------------------------------------------------------------------------------------


def arm():
    """Seven hinges, alternately along and across the links."""
    s = Scene("arm_7", "arm, 7 joints", (0, 0, -9.81), watched="J1")
    z = [0, 0.16, 0.34, 0.54, 0.74, 0.92, 1.08, 1.2]
    masses = [4, 4, 3, 2.7, 1.7, 1.8, 0.3]
    axes = [(0, 0, 1), (0, 1, 0), (0, 0, 1), (0, -1, 0), (0, 0, 1), (0, 1, 0), (0, 0, 1)]
    last = GROUND
    for i in range(7):
        lean = 0.02 * (-1) ** i
        link = s.rod(f"link{i + 1}", (lean, 0.01, z[i]), (0.01, lean, z[i + 1]), masses[i], 0.06)
        s.revolute(f"J{i + 1}", last, link, (0, 0, z[i]), axes[i])
        last = link
    return s


def humanoid():
    """A floating pelvis, 30 hinges: two legs of 6, a waist of 3, two arms of 7, a neck of 1."""
    s = Scene("humanoid", "humanoid, 30 joints", (0, 0, -9.81), watched="waist1")
    x, y, z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    pelvis = s.box("pelvis", (0, 0, 1), (0.2, 0.3, 0.15), 8)

    def chain(name, first, links):
        """`links`: (axis, from, to, mass, radius); a joint where each link begins."""
        last = first
        for i, (axis, start, end, mass, radius) in enumerate(links):
            link = s.rod(f"{name}_link{i + 1}", start, end, mass, radius)
            s.revolute(f"{name}{i + 1}", last, link, start, axis)
            last = link
        return last

    for side, d in (("left", 1), ("right", -1)):
        hip, knee, ankle = np.array([0, 0.1 * d, 0.92]), np.array([0.01, 0.1 * d, 0.5]), np.array([0, 0.1 * d, 0.08])
        chain(side + "_leg", pelvis, [
            (z, hip, hip + (0, 0, -0.04), 0.8, 0.04), (x, hip + (0, 0, -0.04), hip + (0, 0, -0.08), 0.8, 0.04),
            (y, hip + (0, 0, -0.08), knee, 6, 0.06), (y, knee, ankle, 3.5, 0.05),
            (y, ankle, ankle + (0, 0, -0.03), 0.4, 0.03), (x, ankle + (0, 0, -0.03), ankle + (0.15, 0, -0.07), 1.0, 0.04)])
    chest = chain("waist", pelvis, [
        (z, np.array([0, 0, 1.08]), np.array([0, 0, 1.12]), 1.5, 0.06),
        (x, np.array([0, 0, 1.12]), np.array([0, 0, 1.16]), 1.5, 0.06),
        (y, np.array([0, 0, 1.16]), np.array([0, 0, 1.5]), 14, 0.12)])
    for side, d in (("left", 1), ("right", -1)):
        p = [np.array([0, d * (0.2 + k), 1.45]) for k in (0, 0.04, 0.08, 0.3, 0.34, 0.56, 0.6)] + [np.array([0.02, d * 0.9, 1.45])]
        masses, radii, axes = [0.7, 0.7, 1.8, 0.6, 1.2, 0.3, 0.5], [0.04, 0.04, 0.045, 0.04, 0.035, 0.03, 0.04], [y, x, z, y, x, z, x]
        chain(side + "_arm", chest, [(axes[i], p[i], p[i + 1], masses[i], radii[i]) for i in range(7)])
    chain("neck", chest, [(z, np.array([0, 0, 1.52]), np.array([0.02, 0, 1.72]), 4.5, 0.09)])
    return s


def all_scenes(large=()):
    """Those of the table; `large`: more chains of so many four-bars."""
    scenes = [four_bar(), *(n_four_bar(n) for n in (1, 10, 40, 100, 1000)), andrews(), bricard(), three_cranks(), sarrus(),
              delta_robot(), scissor_lift(), arm(), humanoid()]
    return scenes + [n_four_bar(n) for n in large]
