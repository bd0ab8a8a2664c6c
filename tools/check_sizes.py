#!/usr/bin/env python3
"""Reports long files and functions, and fails above the hard limits.

Aim: files of at most 600 lines, functions of at most 60. Above these they are listed; above 800 lines for a file or
120 for a function the check fails. A function's size runs from the line of its name to its closing brace. Tests count
as functions; the brace-matching here knows the style of this project, not all of C++.
"""

import re
import sys

import sources

FILE_AIM, FILE_LIMIT = 600, 800
FUNCTION_AIM, FUNCTION_LIMIT = 60, 120

SCOPE = re.compile(r"\b(?:namespace|class|struct|union|enum|extern)\b")
INITIALIZER = re.compile(r"\)\s*(?:noexcept\b[^:]*)?:(?!:)[^;]*[\w>]\s*$", re.DOTALL)
NAME = re.compile(r"([~\w:]+|operator\s*\S+?)\s*\(")


def without_preprocessor(code):
    return re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: "\n" * m.group(0).count("\n"), code, flags=re.MULTILINE)


def functions(text):
    """(name, first line, last line) of every function body that is not inside another one."""
    code = without_preprocessor(sources.code_only(text))
    found, stack = [], []
    head, head_start = "", None
    inside = 0  # depth within a function body
    line = 1
    for character in code:
        if character == "\n":
            line += 1
        if inside:
            if character == "{":
                inside += 1
            elif character == "}":
                inside -= 1
                if inside == 0:
                    name, first = stack.pop()
                    found.append((name, first, line))
                    head, head_start = "", None
            continue
        if character == "{":
            bare = re.sub(r"<[^<>]*>", "", head)
            if INITIALIZER.search(head):
                stack.append("initializer")
                head += character
                continue
            if ")" in head and not re.search(r"=\s*$", head) and not SCOPE.match(re.sub(r"^.*\btemplate\b", "", bare).strip()):
                match = NAME.search(head)
                stack.append((match.group(1) if match else "?", head_start or line))
                inside = 1
                continue
            stack.append("scope" if SCOPE.search(head) else "list")
            head, head_start = "", None
        elif character == "}":
            if stack and stack.pop() == "initializer":
                head += character
                continue
            head, head_start = "", None
        elif character == ";":
            if "initializer" not in stack:
                head, head_start = "", None
        else:
            if head_start is None and not character.isspace():
                head_start = line
            head += character
    return found


def find_long(files):
    problems, long_ones = [], []
    for path, text in files:
        lines = text.count("\n")
        if lines > FILE_AIM:
            entry = f"{path}:1: {lines} lines"
            (problems if lines > FILE_LIMIT else long_ones).append(entry)
        for name, first, last in functions(text):
            size = last - first + 1
            if size > FUNCTION_AIM:
                entry = f"{path}:{first}: function {name}: {size} lines"
                (problems if size > FUNCTION_LIMIT else long_ones).append(entry)
    return problems, long_ones


def check():
    files = sources.cpp_files()
    problems, long_ones = find_long(files)
    for entry in long_ones:
        print(f"note: {entry}")
    lines = sum(text.count("\n") for _, text in files)
    tests = sum(text.count("\n") for path, text in files if sources.is_test(path))
    summary = f"{len(files)} files, {lines} lines of which {tests} are tests, {len(long_ones)} above the aim"
    return sources.report("check_sizes", problems, summary)


def self_test():
    text = """#include <a>
namespace n {
struct S : T<int> {
  S(int a)
      : a_{a}, b_(2) {
    go();
  }
  int f() const { return 1; }
  std::vector<double> values = {1, 2};
  int a_{3};
};
enum class E { kA, kB };
const std::map<int, int> kMap = make({{1, 2}});
template <class T>
T
long_one(const T& x) {
  if (x) {
    auto f = [&](int i) { return i; };
  }
  // a brace in a comment: }
  return "}";
}
TEST(A, B) {
  run();
}
}  // namespace n
"""
    got = functions(text)
    assert [(n, a, b) for n, a, b in got if n != "make"] == [
        ("S", 4, 7), ("f", 8, 8), ("long_one", 14, 22), ("TEST", 23, 25)], got
    body = "void f() {\n" + "  x();\n" * 200 + "}\n"
    problems, _ = find_long([("a.cc", body)])
    assert len(problems) == 1 and "function f: 202 lines" in problems[0], problems
    problems, notes = find_long([("a.cc", "void f() {\n" + "  x();\n" * 70 + "}\n")])
    assert not problems and len(notes) == 1
    problems, _ = find_long([("a.cc", "int x;\n" * 801)])
    assert len(problems) == 1 and "801 lines" in problems[0], problems


if __name__ == "__main__":
    sys.exit(sources.main("check_sizes", check, self_test))
