"""Writes a scene in the languages that engines read: Ferrers' model file and MuJoCo's."""

from xml.sax.saxutils import quoteattr

import numpy as np

from mechanisms import GROUND


def numbers(values):
    return " ".join(repr(float(x)) for x in values)


def ferrers_yaml(scene):
    name = lambda body: "ground" if body == GROUND else scene.bodies[body].name
    listed = lambda values: "[" + ", ".join(repr(float(x)) for x in values) + "]"
    lines = ["ferrers: 1", f"name: {scene.name}", f"gravity: {listed(scene.gravity)}", "bodies:"]
    for b in scene.bodies:
        i = b.inertia
        inertia = f"{{moments: {listed(np.diag(i))}, products: {listed((i[0, 1], i[0, 2], i[1, 2]))}}}"
        lines.append(f"  {b.name}: {{mass: {b.mass!r}, com: {listed(b.com)}, inertia: {inertia}}}")
    lines.append("joints:")
    for j in scene.joints:
        lines.append(f"  {j.name}: {{type: {j.type}, bodies: [{name(j.a)}, {name(j.b)}], at: {listed(j.at)}, axis: {listed(j.axis)}}}")
    if scene.springs:
        lines.append("forces:")
        for k, s in enumerate(scene.springs):
            lines.append(f"  spring{k}: {{type: spring, bodies: [{name(s.a)}, {name(s.b)}], points: [{listed(s.on_a)}, {listed(s.on_b)}], "
                         f"stiffness: {s.stiffness!r}, free_length: {s.free_length!r}}}")
    if scene.torques:
        lines.append("drives:")
        lines += [f"  motor_{j}: {{joint: {j}, effort: {t!r}}}" for j, t in scene.torques.items()]
    if scene.watched:
        speed = scene.speeds.get(scene.watched, 0)
        lines.append(f"initial: {{{scene.watched}: {{position: 0, velocity: {speed!r}}}}}")
    return "\n".join(lines) + "\n"


def thickened(inertia):
    """A thin rod's inertia with a little about its axis: some versions take no zero. Planar motion does not see it."""
    moments, axes = np.linalg.eigh(inertia)
    least = 1e-9 * moments[-1]
    if moments[0] >= least:
        return inertia
    return inertia + (least - moments[0]) * np.outer(axes[:, 0], axes[:, 0])


def mujoco_xml(scene, points=2, options="", half_spread=0.5):
    """Tree joints as hinges and slides; a joint that closes a loop as `points` connected points of its axis."""
    order, cut = scene.tree()
    children = {}
    for body, joint in order:
        j = None if joint is None else scene.joints[joint]
        parent = GROUND if j is None else (j.a if j.b == body else j.b)
        children.setdefault(parent, []).append((body, j))
    lines = [f"<mujoco model={quoteattr(scene.name)}>",
             '<compiler angle="radian" boundinertia="1e-12" boundmass="0"/>',
             f'<option gravity="{numbers(scene.gravity)}" {options}><flag contact="disable" limit="disable" warmstart="disable"/></option>',
             "<worldbody>"]

    def sites(body, origin):
        for k, s in enumerate(scene.springs):
            for end, on, at in (("a", s.a, s.on_a), ("b", s.b, s.on_b)):
                if on == body:
                    lines.append(f'<site name="spring{k}{end}" pos="{numbers(at - origin)}"/>')

    def place(parent, parent_origin):
        sites(parent, parent_origin)
        for body, j in children.get(parent, []):
            b = scene.bodies[body]
            origin = b.com if j is None else j.at
            lines.append(f'<body name="{b.name}" pos="{numbers(origin - parent_origin)}">')
            i = thickened(b.inertia)
            lines.append(f'<inertial pos="{numbers(b.com - origin)}" mass="{b.mass!r}" '
                         f'fullinertia="{numbers((i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]))}"/>')
            if j is None:
                lines.append('<freejoint name="free"/>')
            else:
                kind = {"revolute": "hinge", "prismatic": "slide"}[j.type]
                axis = j.axis if j.b == body else -j.axis
                lines.append(f'<joint name="{j.name}" type="{kind}" axis="{numbers(axis)}"/>')
            place(body, origin)
            lines.append("</body>")

    place(GROUND, np.zeros(3))
    lines.append("</worldbody>")
    origins = {GROUND: np.zeros(3)}
    for body, joint in order:
        origins[body] = scene.bodies[body].com if joint is None else scene.joints[joint].at
    if cut:
        lines.append("<equality>")
        for k in cut:
            j = scene.joints[k]
            if j.type != "revolute":
                raise ValueError("a prismatic joint that closes a loop")
            a, b = ("world" if x == GROUND else scene.bodies[x].name for x in (j.a, j.b))
            first, second, origin = (a, b, origins[j.a]) if j.a != GROUND else (b, a, origins[j.b])
            offsets = (0,) if points == 1 else (-half_spread, half_spread)
            for offset in offsets:
                lines.append(f'<connect body1="{first}" body2="{second}" anchor="{numbers(j.at + offset * j.axis - origin)}"/>')
        lines.append("</equality>")
    if scene.springs:
        lines.append("<tendon>")
        for k, s in enumerate(scene.springs):
            lines.append(f'<spatial stiffness="{s.stiffness!r}" springlength="{s.free_length!r}"><site site="spring{k}a"/><site site="spring{k}b"/></spatial>')
        lines.append("</tendon>")
    lines.append("</mujoco>")
    return "\n".join(lines) + "\n"
