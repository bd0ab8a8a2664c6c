#!/usr/bin/env python3
"""Runs clang-tidy on the library and the command, and remembers which files were clean.

The checks are those of .clang-tidy. A file is looked at again when it, a header that it includes (directly or not),
.clang-tidy or its compile command has changed; the memory is a folder of empty files in the build folder. Tests are
left out: their macros are not ours.
"""

import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import time

import sources

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def digest(path, command, cache):
    """A number that changes with anything that the verdict on `path` depends on."""
    seen, open_ones = set(), [path]
    total = hashlib.sha256((command + cache["config"]).encode())
    while open_ones:
        current = open_ones.pop()
        if current in seen or not current.is_file():
            continue
        seen.add(current)
        if current not in cache:
            cache[current] = current.read_text(encoding="utf-8")
        total.update(cache[current].encode())
        for name in sorted(INCLUDE.findall(cache[current])):
            open_ones += [sources.ROOT / name, current.parent / name]
    return total.hexdigest()


def main():
    parser = argparse.ArgumentParser(description="clang-tidy on what has changed")
    parser.add_argument("--build", default="build/test", help="build folder with compile_commands.json")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--program", default="clang-tidy-14")
    parser.add_argument("files", nargs="*", help="only these sources")
    options = parser.parse_args()

    build = (sources.ROOT / options.build).resolve()
    memory = build / "tidy"
    memory.mkdir(parents=True, exist_ok=True)
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    cache = {"config": (sources.ROOT / ".clang-tidy").read_text(encoding="utf-8")}
    only = {pathlib.Path(name).resolve() for name in options.files}
    waiting, remembered, known = [], 0, set()
    for entry in commands:
        path = pathlib.Path(entry["directory"], entry["file"]).resolve()
        try:
            name = path.relative_to(sources.ROOT).as_posix()
        except ValueError:
            continue
        if sources.is_test(name) or not name.startswith(("ferrers/", "apps/")) or (only and path not in only):
            continue
        if path in known:  # compiled once more, under sanitizers
            continue
        known.add(path)
        mark = memory / digest(path, entry["command"], cache)
        if mark.exists():
            remembered += 1
        else:
            waiting.append((name, path, mark))

    def look(item):
        name, path, mark = item
        start = time.monotonic()
        # The compile commands are for g++, which knows warnings that clang does not.
        command = [options.program, "--quiet", "--extra-arg=-Wno-unknown-warning-option", "-p", str(build), str(path)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode == 0 and "warning:" not in done.stdout:
            mark.touch()
        return name, done, time.monotonic() - start

    bad = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name, done, seconds in pool.map(look, waiting):
            findings = done.stdout.strip()
            if done.returncode != 0 or "warning:" in findings:
                bad += 1
                print(findings or done.stderr.strip())
            print(f"{name}: {'findings' if done.returncode or 'warning:' in findings else 'clean'} ({seconds:.1f} s)")
    print(f"run_tidy: {bad} files with findings, {len(waiting)} looked at, {remembered} unchanged since they were clean")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
