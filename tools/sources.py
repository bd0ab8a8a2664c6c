"""What the source checks share: finding the C++ files, and reading them without comments and strings."""

import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
CPP_FOLDERS = ("ferrers", "apps", "examples", "tests", "bench")


def cpp_files(root=ROOT, folders=CPP_FOLDERS):
    """Every .h and .cc file under the folders, as sorted (path relative to root, text) pairs."""
    found = []
    for folder in folders:
        for directory, names, files in os.walk(root / folder):
            names.sort()
            for name in sorted(files):
                if name.endswith((".h", ".cc")):
                    path = pathlib.Path(directory, name)
                    found.append((path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")))
    return found


def is_test(path):
    """Whether a file is allowed to use ferrers/testing."""
    return path.endswith("_test.cc") or path.startswith(("tests/", "bench/", "ferrers/testing/"))


_PIECES = re.compile(
    r'(?P<comment>//[^\n]*|/\*.*?\*/)'
    r'|(?P<raw>\bR"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)")'
    r'|(?P<string>"(?:\\.|[^"\\\n])*")'
    r"|(?P<digits>\b[0-9][0-9a-fA-FxX']*)"
    r"|(?P<char>'(?:\\.|[^'\\\n])+')",
    re.DOTALL,
)


def code_only(text, keep_strings=False):
    """The text with comments, strings and characters blanked; every line keeps its number."""

    def blank(match):
        piece = match.group(0)
        if match.group("digits") or (keep_strings and not match.group("comment")):
            return piece
        inside = re.sub(r"[^\n]", " ", piece)
        if match.group("comment"):
            return inside
        return '"' + inside[1:-1] + '"' if len(piece) > 1 else piece

    return _PIECES.sub(blank, text)


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def report(name, problems, summary):
    """Prints the problems; returns the exit code."""
    for problem in problems:
        print(problem)
    print(f"{name}: {len(problems)} problems, {summary}" if problems else f"{name}: fine, {summary}")
    return 1 if problems else 0


def main(name, check, self_test, argv=None):
    """The command line that every check has: no arguments, or --self-test."""
    arguments = sys.argv[1:] if argv is None else argv
    if arguments == ["--self-test"]:
        self_test()
        print(f"{name}: the self-test passed")
        return 0
    if arguments:
        print(f"usage: {name} [--self-test]", file=sys.stderr)
        return 2
    return check()
