#!/usr/bin/env python3
"""Fails where a rank is decided outside ferrers/math/rank.*: one place compares a number with a rank tolerance.

In ferrers/ and apps/, tests apart, it looks for (comments and strings do not count):
  threshold    .setThreshold(...)                 gives Eigen a rank tolerance
  rank         .rank(), .dimensionOfKernel(), .isInvertible(), .isInjective(), .isSurjective(), .kernel(), .image(),
               .nonzeroPivots()                   asks Eigen, which compares with a tolerance of its own
  decision     CompleteOrthogonalDecomposition, FullPivLU, FullPivHouseholderQR, .pseudoInverse()
                                                  solvers that decide a rank inside
  name         kRankTolerance, rank_tolerance, singular_value_threshold, sv_tol and the like
  comparison   a singular value, named so, on one side of <, <=, >, >= (sizes and loop counters excepted; a comparison
               has spaces around it, as the format check makes sure, a template has none)

A line that matches without deciding a rank says why in a comment of its own or of the line before it:
`// not a rank decision: <reason>`.
"""

import re
import sys

import sources

VALUE = r"(?:singular_?values?_?|singularValues|sigmas?|sigma_(?:max|min)|sv)\b"
TAIL = r"(?:\s*\(\s*\))?(?:\s*\[[^\]]*\]|\s*\([^()]*\)|\s*\.\s*(?:head|tail|segment)\s*(?:<\d+>)?\([^()]*\)|\s*\.\s*(?:back|front|minCoeff|maxCoeff|value)\s*\(\s*\))*"
COUNT = r"(?!\s*(?:\(\s*\)\s*)?\.\s*(?:size|rows|cols|begin|end|empty)\s*\()"

PATTERNS = (
    ("threshold", re.compile(r"(?:\.|->)\s*setThreshold\s*\(")),
    ("rank", re.compile(r"(?:\.|->)\s*(?:rank|dimensionOfKernel|isInvertible|isInjective|isSurjective|kernel|image|nonzeroPivots)\s*\(")),
    ("decision", re.compile(r"\b(?:CompleteOrthogonalDecomposition|FullPivLU|FullPivHouseholderQR)\b|(?:\.|->)\s*pseudoInverse\s*\(")),
    ("name", re.compile(
        r"\b\w*(?:rank|singular_?values?|sv|pivot)_?(?:relative_?)?(?:tol|tolerance|threshold|eps|epsilon|cutoff)\w*", re.IGNORECASE)),
    ("comparison", re.compile(rf"\b\w*{VALUE}{COUNT}{TAIL}\s+(?:<=?|>=?)\s+[\w.(\-]")),
    ("comparison", re.compile(rf"[\w)\]]\s+(?:<=?|>=?)\s+(?:\w+(?:\.|->))*{VALUE}{COUNT}")),
)
WAIVER = re.compile(r"//.*not a rank decision: \w+")


def exempt(path):
    return sources.is_test(path) or re.match(r"ferrers/math/rank(_\w+)?\.(h|cc)$", path) is not None


def find_problems(files):
    problems, waived = [], 0
    for path, text in files:
        if exempt(path) or not path.startswith(("ferrers/", "apps/")):
            continue
        lines = text.split("\n")
        code = sources.code_only(text)
        found = {}
        for kind, pattern in PATTERNS:
            for match in pattern.finditer(code):
                found.setdefault(sources.line_of(code, match.start()), (kind, " ".join(match.group(0).split())))
        for line in sorted(found):
            kind, what = found[line]
            if any(WAIVER.search(lines[i]) for i in (line - 1, line - 2) if i >= 0):
                waived += 1
                continue
            problems.append(f"{path}:{line}: {kind}: `{what}` decides a rank outside ferrers/math/rank")
    return problems, waived


def check():
    files = sources.cpp_files()
    problems, waived = find_problems(files)
    return sources.report("check_rank", problems, f"{len(files)} files, {waived} lines explained as no rank decision")


def self_test():
    path = "ferrers/redundancy/x.cc"
    planted = {
        "threshold": ["qr.setThreshold(1e-10);", "qr->setThreshold ( 0 );"],
        "rank": ["int r = qr.rank();", "if (lu.isInvertible()) {", "auto n = lu.kernel();", "qr.dimensionOfKernel ()"],
        "decision": ["Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod(A);", "Eigen::FullPivLU<Matrix3d> lu;"],
        "name": ["constexpr double kRankTolerance = 1e-9;", "double rank_tolerance = 1;", "double svTol = 1;",
                 "const double singular_value_threshold = 0.1;", "options.rank_eps = 2;", "double pivot_threshold;"],
        "comparison": ["if (svd.singularValues()(i) < 1e-12) ++n;", "while (singular_values[k] >= limit * singular_values[0]) {",
                       "if (1e-9 > svd.singularValues()[0]) {", "return sigma[i] > eps;", "if (tol * top < sigma(k)) {",
                       "ok = result.singular_values.back() <= 1e-8;", "if (d.singular_values\n    (i) < small) {"],
    }
    for kind, lines in planted.items():
        for line in lines:
            problems, _ = find_problems([(path, "void f() {\n" + line + "\n}\n")])
            assert len(problems) == 1 and f": {kind}:" in problems[0], (kind, line, problems)
            for place in ("ferrers/math/rank.cc", "ferrers/math/rank.h", "ferrers/math/x_test.cc", "tests/x_test.cc"):
                assert find_problems([(place, line)])[0] == [], (place, line)
            assert find_problems([("ferrers/math/ranking.cc", line)])[0], "only rank.* is exempt"
            assert find_problems([(path, "// not a rank decision: a printed figure\n" + line)]) == ([], 1), line
            assert find_problems([(path, "// not a rank decision:\n" + line)])[0], "a waiver needs its reason"
            assert find_problems([(path, "// " + " ".join(line.split()) + "\n")])[0] == [], "comments do not count"
    harmless = (
        "for (int i = 0; i < singular_values.size(); ++i) total += singular_values[i];",
        "std::vector<double> singular_values;", "const VectorXd& singular_values() const;", "int rank = decision.rank;",
        "while (i < svd.singularValues().size()) ++i;", "Eigen::Map<const VectorXd> sigma(data, n);",
        "for (size_t k = 0; k < r.singular_values.size(); ++k) {", 'message = "rank_tolerance";', "std::vector<double> frank;",
        "out << singular_values[0];", "double step_tolerance = 1e-9;", "report.singular_values = decision.singular_values;",
    )
    for line in harmless:
        assert find_problems([(path, line)])[0] == [], (line, find_problems([(path, line)])[0])


if __name__ == "__main__":
    sys.exit(sources.main("check_rank", check, self_test))
