#!/usr/bin/env python3
"""Which URDF files of a folder Ferrers reads, as a table in Markdown: one row a file.

    python3 load_urdf_files.py build/test/bin/model_probe FOLDER

The files are those of others, for example of the package example-robot-data (pip download --no-deps
example-robot-data, unpacked). Where no file is read, the first error says why.
"""

import json
import pathlib
import re
import subprocess
import sys

ERROR = re.compile(r":(\d+:\d+: )?error\[(F\d+)\]: (.*)")


def load(probe, path):
    """What the probe prints of a file, or the first error as text and how many more there are."""
    run = subprocess.run([probe, str(path)], input='{"states": []}', capture_output=True, text=True, timeout=120)
    if run.returncode == 0:
        return json.loads(run.stdout), None
    errors = [(place or "", code, message) for place, code, message in ERROR.findall(run.stderr)]
    if not errors:
        return None, f"exit code {run.returncode}"
    place, code, message = errors[0]
    more = f", and {len(errors) - 1} more" if len(errors) > 1 else ""
    return None, f"refused, {place}{code}: {message}{more}"


def main():
    if len(sys.argv) != 3:
        print(__doc__, file=sys.stderr)
        return 64
    folder = pathlib.Path(sys.argv[2])
    files = sorted(folder.rglob("*.urdf"))
    loaded = 0
    print("| file | bodies | coordinates | |\n|---|---|---|---|")
    for path in files:
        found, reason = load(sys.argv[1], path)
        name = f"{path.parts[-3].removesuffix('_description')}/{path.name}" if len(path.parts) > 2 else path.name
        if found:
            loaded += 1
            print(f"| {name} | {len(found['bodies']) - 1} | {len(found['velocities'])} | loads |")
        else:
            print(f"| {name} | | | {reason} |")
    share = 100 * loaded / max(1, len(files))
    print(f"\n{loaded} of {len(files)} files load ({share:.1f} %).")
    return 0


if __name__ == "__main__":
    sys.exit(main())
