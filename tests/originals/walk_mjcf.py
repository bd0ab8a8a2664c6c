#!/usr/bin/env python3
"""Reads every MJCF file below some folders and says what became of it: read, or refused and why; none may crash or hang.

    pip download --no-deps mujoco-mjx && unzip mujoco_mjx*.whl -d wheel
    tests/originals/walk_mjcf.py wheel --probe build/test/bin/model_probe [--markdown TABLE.md]

Files without the root <mujoco> are parts of others and are passed over. With --originals and a Python that has mujoco,
files that were read are also compared with it (compare_mujoco.py). Exit code 1 after a crash or a time-out.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys

TIME_LIMIT_S = 60


def is_model(path):
    text = path.read_text(encoding="utf-8", errors="replace")
    text = re.sub(r"<!--.*?-->|<\?.*?\?>|<!.*?>", "", text, flags=re.DOTALL)
    return re.match(r"\s*<mujoco[\s>/]", text) is not None


def try_file(path, probe):
    """(verdict, reason); verdict: read, refused, crashed, timed out."""
    try:
        run = subprocess.run([probe, str(path)], input='{"states": [{}]}', capture_output=True, text=True,
                             timeout=TIME_LIMIT_S, check=False, errors="replace")
    except subprocess.TimeoutExpired:
        return "timed out", f"{TIME_LIMIT_S} s"
    if run.returncode == 3:
        errors = re.findall(r"error\[(F\d+)\]: (.*)", run.stderr)
        first = f"{errors[0][0]}: {errors[0][1]}" if errors else run.stderr.strip()
        return "refused", first + (f" (and {len(errors) - 1} more)" if len(errors) > 1 else "")
    if run.returncode != 0:
        return "crashed", (run.stderr.strip().splitlines() or [f"exit code {run.returncode}"])[-1]
    told = json.loads(run.stdout)
    return "read", f"{len(told['bodies']) - 1} bodies, {len(told['velocities'])} coordinates, {len(told['rows'])} rows"


def compare_file(path, probe):
    """What compare_mujoco says of a file that was read."""
    import compare_mujoco  # needs mujoco, which not everybody has
    try:
        found = compare_mujoco.compare_with_fallback(str(path), probe, states=5, seed=1)
    except Exception as error:
        return f"not compared: {str(error).strip().splitlines()[0][:150]}"
    worst = max(found, key=found.get)
    return f"greatest difference {found[worst]:.0e} ({worst})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=pathlib.Path)
    parser.add_argument("--probe", default="build/test/bin/model_probe")
    parser.add_argument("--markdown", type=pathlib.Path)
    parser.add_argument("--originals", action="store_true")
    options = parser.parse_args()
    lines, counts = ["| file | verdict | reason |", "|---|---|---|"], {}
    for folder in options.folders:
        for path in sorted(folder.rglob("*.xml")):
            if not is_model(path):
                continue
            verdict, reason = try_file(path, options.probe)
            counts[verdict] = counts.get(verdict, 0) + 1
            if options.originals and verdict == "read":
                reason += "; " + compare_file(path, options.probe)
            print(f"{path.relative_to(folder)}: {verdict}: {reason}", flush=True)
            lines.append(f"| {path.relative_to(folder)} | {verdict} | {reason} |".replace("\n", " "))
    if options.markdown:
        options.markdown.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(counts.items())))
    return 1 if "crashed" in counts or "timed out" in counts else 0


if __name__ == "__main__":
    sys.exit(main())
