#!/usr/bin/env python3
"""Fails where a tracked file names a place that exists only on one person's machine.

The project speaks of itself alone: its files do not know the folder that it happens to be developed in. Looked for are
absolute paths of home and work folders, a path that climbs out of the repository to a shared folder, and merge marks.
Outside a git checkout every file is read, build results apart.
"""

import os
import pathlib
import re
import subprocess
import sys

import sources

# Written in pieces, so that this file does not match itself.
WORDS = [
    (re.compile(r"(?<![\w.}/])/" + "work/"), "an absolute path of a work folder"),
    (re.compile(r"\.\./" + r"shared\b"), "a folder outside the repository"),
    (re.compile("/tmp/" + "research"), "a folder of one machine"),
    (re.compile(r"(?<![\w.])/" + "farm/"), "a folder of one machine"),
    (re.compile(r"(?<![\w.])/(?:home|Users)/" + r"[a-z]\w*/"), "a home folder"),
    (re.compile("^(?:<{7}|>{7}) ", re.MULTILINE), "a merge mark"),
]
SKIPPED_FOLDERS = {".git", "build", "out", ".venv", "node_modules", "__pycache__"}


def tracked_files(root):
    try:
        done = subprocess.run(["git", "-C", str(root), "ls-files", "-z"], capture_output=True, check=True)
        names = [os.fsdecode(name) for name in done.stdout.split(b"\0") if name]
        if names:
            return [root / name for name in names]
    except (OSError, subprocess.CalledProcessError):
        pass
    found = []
    for directory, folders, files in os.walk(root):
        folders[:] = sorted(set(folders) - SKIPPED_FOLDERS)
        found += [pathlib.Path(directory, name) for name in sorted(files)]
    return found


def find_problems(texts):
    problems = []
    for path, text in texts:
        for pattern, what in WORDS:
            for match in pattern.finditer(text):
                problems.append(f"{path}:{sources.line_of(text, match.start())}: {what}: {match.group(0)}")
    return problems


def check():
    texts = []
    for path in tracked_files(sources.ROOT):
        try:
            texts.append((path.relative_to(sources.ROOT).as_posix(), path.read_text(encoding="utf-8")))
        except (UnicodeDecodeError, FileNotFoundError, IsADirectoryError):
            continue  # a binary file, or one that is deleted but not yet committed
    return sources.report("check_words", find_problems(texts), f"{len(texts)} files")


def self_test():
    for planted in ("cd /" + "work/main", "see ../" + "shared/method.md", "/tmp/" + "research/x", "/home/" + "ann/ferrers",
                    "a\n" + "<" * 7 + " HEAD\n"):
        assert len(find_problems([("a.md", planted)])) == 1, planted
    for harmless in ("frame/work/done", "virtual work/power", "shared/x", "../shared_memory.h", "homework", "=======\n"):
        assert find_problems([("a.md", harmless)]) == [], harmless
    names = {path.name for path in tracked_files(sources.ROOT)}
    assert "CMakeLists.txt" in names


if __name__ == "__main__":
    sys.exit(sources.main("check_words", check, self_test))
