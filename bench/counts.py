#!/usr/bin/env python3
"""Instructions of one evaluation of forward dynamics, counted by callgrind: the same figures on a busy machine.

Two runs that differ in nothing but the number of evaluations are subtracted. Of the evaluation part by part the
counts of each part are told as well; native code is one piece.

    bench/counts.py --program build/bench/bin/ferrers_counted --output bench/history/DATE-instructions.json
"""

import argparse
import datetime
import json
import pathlib
import re
import subprocess
import sys
import tempfile

MECHANISMS = ["four_bar", "bricard", "three_cranks", "andrews", "a02_n10", "a02_n100"]
PARTS = {
    "positions": "compute_positions",
    "velocities": "compute_velocities",
    "constraints": "compute_constraints",
    "mass and bias": "compute_mass_and_bias",
    "applied forces": "compute_applied_forces",
    "factors": "SparseKkt::factor",
    "solution": "SparseKkt::solve",
}
FEW, MANY = 200, 1200


def run(program, mechanism, what, evaluations, folder):
    """Instructions in all, and by function with what it calls."""
    out = folder / f"{mechanism}.{what}.{evaluations}"
    subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", program, mechanism, what,
                    str(evaluations)], check=True, capture_output=True)
    listing = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(out)], check=True,
                             capture_output=True, text=True).stdout
    counts = {}
    for line in listing.splitlines():
        found = re.match(r"\s*([\d,]+) \([ \d.]+%\)\s+(.*)", line)
        if found:
            counts[found[2]] = int(found[1].replace(",", ""))
    return counts["PROGRAM TOTALS"], counts


def per_evaluation(program, mechanism, what, folder):
    few, few_by_function = run(program, mechanism, what, FEW, folder)
    many, many_by_function = run(program, mechanism, what, MANY, folder)
    result = {"instructions": round((many - few) / (MANY - FEW), 1)}
    if what == "parts":
        def count(by_function, name):
            return max((n for function, n in by_function.items() if f"{name}(" in function), default=0)
        result["of which"] = {
            title: round((count(many_by_function, name) - count(few_by_function, name)) / (MANY - FEW), 1)
            for title, name in PARTS.items()}
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--output", type=pathlib.Path)
    options = parser.parse_args()
    version = subprocess.run(["valgrind", "--version"], capture_output=True, text=True, check=True).stdout.strip()
    record = {"date": datetime.date.today().isoformat(), "tool": version, "evaluation": {}}
    with tempfile.TemporaryDirectory() as folder:
        for mechanism in MECHANISMS:
            record["evaluation"][mechanism] = {
                what: per_evaluation(options.program, mechanism, what, pathlib.Path(folder))
                for what in ("native", "parts")}
            print(mechanism, json.dumps(record["evaluation"][mechanism]), flush=True)
    if options.output:
        options.output.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
