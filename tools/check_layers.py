#!/usr/bin/env python3
"""Fails where a folder includes what stands below it in the order of layers.

The order is FERRERS_LAYERS in CMakeLists.txt: each layer may include itself and the layers before it. Also:
  - ferrers/testing is included only by *_test.cc, tests/, bench/ and itself;
  - core does not include Eigen;
  - files do not include each other in a circle;
  - an include in quotes starts at ferrers/ and names a file that exists (apps, tests and bench may also include
    their neighbours by name);
  - the library does not print: no <iostream>, std::cout, std::cerr or printf outside tests;
  - topology holds no floating-point number.
"""

import posixpath
import re
import sys

import sources

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.MULTILINE)
PRINTS = re.compile(r"#\s*include\s*<(?:iostream|cstdio|stdio\.h|print)>|\bstd::(?:cout|cerr|clog)\b|\bf?printf\s*\(|\bfmt::print\b")
FLOATING = re.compile(r"\b(?:double|float|VectorXd|MatrixXd|Vector3d)\b")


def read_layers(cmake_text):
    match = re.search(r"set\(FERRERS_LAYERS\s+([^)]*)\)", cmake_text)
    if not match:
        raise ValueError("CMakeLists.txt does not set FERRERS_LAYERS")
    return match.group(1).split()


def layer_of(path):
    parts = path.split("/")
    return parts[1] if parts[0] == "ferrers" and len(parts) > 2 else None


def find_cycles(graph):
    """Each circle of includes once, found by depth-first search without recursion."""
    cycles, done = [], set()
    for first in sorted(graph):
        if first in done:
            continue
        trail, on_trail = [first], {first}
        stack = [iter(sorted(graph[first]))]
        while stack:
            following = next(stack[-1], None)
            if following is None:
                stack.pop()
                done.add(trail[-1])
                on_trail.discard(trail.pop())
            elif following in on_trail:
                cycles.append(trail[trail.index(following):] + [following])
            elif following not in done and following in graph:
                trail.append(following)
                on_trail.add(following)
                stack.append(iter(sorted(graph[following])))
    return cycles


def find_problems(files, layers):
    """`files` is a list of (path, text); returns lines `path:line: what`."""
    problems, graph = [], {path: set() for path, _ in files}
    for path, text in files:
        layer = layer_of(path)
        code = sources.code_only(text)
        with_strings = sources.code_only(text, keep_strings=True)
        if layer and layer != "testing" and layer not in layers:
            problems.append(f"{path}:1: '{layer}' is no layer; add it to FERRERS_LAYERS or move the file")
        for match in INCLUDE.finditer(with_strings):
            quote, target = match.groups()
            place = f"{path}:{sources.line_of(with_strings, match.start())}"
            if quote == "<":
                if layer == "core" and re.match(r"(unsupported/)?Eigen/", target) and not sources.is_test(path):
                    problems.append(f"{place}: core includes Eigen")
                continue
            if not target.startswith("ferrers/"):
                neighbour = posixpath.normpath(posixpath.join(posixpath.dirname(path), target))
                if layer is not None:
                    problems.append(f'{place}: write "ferrers/LAYER/..." instead of "{target}"')
                elif neighbour in graph:
                    graph[path].add(neighbour)
                elif target in graph:
                    graph[path].add(target)
                else:
                    problems.append(f'{place}: "{target}" does not exist')
                continue
            if target not in graph:
                problems.append(f'{place}: "{target}" does not exist')
                continue
            graph[path].add(target)
            wanted = layer_of(target)
            if wanted == "testing":
                if not sources.is_test(path):
                    problems.append(f"{place}: only tests and benchmarks may include ferrers/testing")
            elif layer in layers and wanted in layers and layers.index(wanted) > layers.index(layer):
                problems.append(f"{place}: {layer} may not include {wanted}, which stands below it")
        if layer in layers and not sources.is_test(path):
            for match in PRINTS.finditer(code):
                problems.append(f"{path}:{sources.line_of(code, match.start())}: the library does not print")
        if layer == "topology" and not sources.is_test(path):
            for match in FLOATING.finditer(code):
                problems.append(f"{path}:{sources.line_of(code, match.start())}: topology holds no floating-point number")
    for cycle in find_cycles(graph):
        problems.append(f"{cycle[0]}:1: files include each other: {' -> '.join(cycle)}")
    return problems


def check():
    layers = read_layers((sources.ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))
    files = sources.cpp_files()
    return sources.report("check_layers", find_problems(files, layers), f"{len(files)} files, order {' < '.join(layers)}")


def self_test():
    layers = read_layers("set(FERRERS_LAYERS core math\n  topology io)")
    assert layers == ["core", "math", "topology", "io"]
    good = [
        ("ferrers/core/a.h", "#include <string>\n"),
        ("ferrers/math/b.h", '#include <Eigen/Core>\n#include "ferrers/core/a.h"\n// #include "ferrers/io/r.h"\n'),
        ("ferrers/math/b_test.cc", '#include <Eigen/Core>\n#include "ferrers/testing/t.h"\n#include <iostream>\n'),
        ("ferrers/testing/t.h", '#include "ferrers/math/b.h"\n'),
        ("ferrers/topology/g.h", "// a double edge\nint edges;\n"),
        ("apps/ferrers/main.cc", '#include "verbs.h"\n#include <iostream>\n'),
        ("apps/ferrers/verbs.h", '#include "ferrers/math/b.h"\n'),
    ]
    assert find_problems(good, layers) == [], find_problems(good, layers)

    planted = {
        "math may not include io": [("ferrers/math/x.h", '#include "ferrers/io/r.h"\n'), ("ferrers/io/r.h", "")],
        "core includes Eigen": [("ferrers/core/x.h", "#include <Eigen/Dense>\n")],
        "only tests and benchmarks": [("ferrers/io/x.cc", '#include "ferrers/testing/t.h"\n')],
        "include each other": [
            ("ferrers/math/x.h", '#include "ferrers/math/y.h"\n'),
            ("ferrers/math/y.h", '#include "ferrers/math/x.h"\n'),
        ],
        "does not exist": [("ferrers/math/x.h", '#include "ferrers/math/gone.h"\n')],
        'write "ferrers/LAYER/..."': [("ferrers/math/x.h", '#include "b.h"\n')],
        "does not print": [("ferrers/io/x.cc", 'void f() { std::cerr << "no"; }\n')],
        "no floating-point": [("ferrers/topology/x.h", "double length;\n")],
        "is no layer": [("ferrers/misc/x.h", "")],
    }
    for what, extra in planted.items():
        problems = find_problems(good + extra, layers)
        assert len(problems) == 1 and what in problems[0], (what, problems)


if __name__ == "__main__":
    sys.exit(sources.main("check_layers", check, self_test))
