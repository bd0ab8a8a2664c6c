#!/usr/bin/env python3
"""Writes the chain of N four-bar linkages as a model file: generate.py N [--horizontal] > model.yaml

N + 1 upright cranks stand on ground pivots one rod length apart, N couplers join the tips of neighbours.
The joint axes point along -z, so that a crank angle counts clockwise from upright, as the benchmark counts it.
With --horizontal everything is drawn after a quarter turn, in the singular pose where all rods lie on one line.
"""
import sys


def along(count):
    """`count` rod lengths, as the model file writes it."""
    return "0" if count == 0 else "= length" if count == 1 else f"= {count}*length"


def model(n, horizontal=False):
    foot = [(along(i), "0") for i in range(n + 1)]
    tip = [(along(i + 1), "0") if horizontal else (along(i), "= length") for i in range(n + 1)]
    rod = "  {0}: {{mass: = m, inertia: {{shape: rod, from: [{1[0]}, {1[1]}, 0], to: [{2[0]}, {2[1]}, 0]}}}}"
    joint = "  {0}: {{type: revolute, bodies: [{1}, {2}], at: [{3[0]}, {3[1]}, 0], axis: [0, 0, -1]}}"
    lines = [
        "ferrers: 1",
        f"name: n-four-bar-a02-n{n}" + ("-horizontal" if horizontal else ""),
        "gravity: [0, -9.81, 0]",
        "",
        "parameters:",
        "  length: {value: 1 m, doc: every rod}",
        "  m: {value: 1 kg, doc: every rod}",
        "  tip_speed: {value: 1 m/s, doc: of the crank tips at the start}",
        "",
        "bodies:",
    ]
    lines += [rod.format(f"crank{i}", foot[i], tip[i]) for i in range(n + 1)]
    lines += [rod.format(f"coupler{i}", tip[i], tip[i + 1]) for i in range(n)]
    lines += ["", "joints:"]
    lines += [joint.format(f"pivot{i}", "ground", f"crank{i}", foot[i]) for i in range(n + 1)]
    for i in range(n):
        lines.append(joint.format(f"left{i}", f"crank{i}", f"coupler{i}", tip[i]))
        lines.append(joint.format(f"right{i}", f"coupler{i}", f"crank{i + 1}", tip[i + 1]))
    lines.append("")
    if not horizontal:
        lines.append("initial: {pivot0: {position: 0, velocity: = tip_speed/length}}")
    lines.append(f"record: {{B0: {{body: crank0, at: [{tip[0][0]}, {tip[0][1]}, 0]}}}}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    options = [a for a in sys.argv[1:] if a == "--horizontal"]
    counts = [a for a in sys.argv[1:] if a != "--horizontal"]
    if len(counts) != 1 or not counts[0].isdecimal() or int(counts[0]) < 1:
        sys.exit("usage: generate.py N [--horizontal]    (N >= 1 loops; the model file goes to standard output)")
    sys.stdout.write(model(int(counts[0]), bool(options)))
