#!/usr/bin/env python3
"""Fails where a source or page cites what docs/references.bib does not hold.

A citation is written [key] or [key, place], for example [stepanyan, eq. (5)], [featherstone2008, ch. 9] or
[wojtyra2005, sec. 3]. A key is in lower case; the place starts with eq., sec., ch., p., fig., tab., alg. or thm.
Only comments of C++ files and the text of pages count. Also checked: keys in the bibliography are unique, and each
entry has an author (or editor) and a title.
"""

import re
import sys

import sources

PLACE = r"(?:eqs?|sec|ch|pp?|fig|tab|alg|thm)\. ?[^\]\n]+"
WITH_PLACE = re.compile(rf"\[([A-Za-z][A-Za-z0-9_-]*), ({PLACE})\]")
BARE_WITH_YEAR = re.compile(r"\[([A-Za-z]+(?:_[a-z]+)*[12][0-9]{3}[a-z]?)\](?!\()")
NEAR_MISS = re.compile(r"\[[A-Z][a-z]+(?: et al\.?)?,? (?:\(\d|eq|Eq|\d{4})[^\]\n]*\]|\[[a-z][a-z0-9_]*, ?\(\d+\)\]")
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def read_bibliography(text):
    """(keys, problems) of a BibTeX text."""
    problems, keys = [], set()
    starts = list(re.finditer(r"^@(\w+)\{([^,\s]+),", text, re.MULTILINE))
    for index, start in enumerate(starts):
        key = start.group(2)
        end = starts[index + 1].start() if index + 1 < len(starts) else len(text)
        body = text[start.end():end]
        place = f"docs/references.bib:{sources.line_of(text, start.start())}"
        if key in keys:
            problems.append(f"{place}: '{key}' stands twice")
        keys.add(key)
        if key != key.lower():
            problems.append(f"{place}: '{key}' is not in lower case")
        if not re.search(r"^\s*(?:author|editor)\s*=", body, re.MULTILINE):
            problems.append(f"{place}: '{key}' has no author")
        if not re.search(r"^\s*title\s*=", body, re.MULTILINE):
            problems.append(f"{place}: '{key}' has no title")
    return keys, problems


def comments_only(text):
    """The comments of a C++ text at their lines."""
    kept = re.sub(r"[^\n]", " ", text)
    pieces = list(kept)
    without_strings = re.sub(r'"(?:\\.|[^"\\\n])*"', lambda m: '"' + " " * (len(m.group(0)) - 2) + '"', text)
    for match in COMMENT.finditer(without_strings):
        pieces[match.start():match.end()] = text[match.start():match.end()]
    return "".join(pieces)


def find_problems(texts, keys):
    """`texts` is a list of (path, text to look in); returns (problems, number of citations)."""
    problems, count = [], 0
    plain_keys = re.compile("|".join(rf"\[({re.escape(key)})\](?!\()" for key in sorted(keys)) or r"(?!)")
    for path, text in texts:
        cited = [(m.start(), m.group(1)) for m in WITH_PLACE.finditer(text)]
        cited += [(m.start(), m.group(1)) for m in BARE_WITH_YEAR.finditer(text)]
        known = {offset for offset, _ in cited}
        cited += [(m.start(), m.group(0)[1:-1]) for m in plain_keys.finditer(text) if m.start() not in known]
        count += len(cited)
        for offset, key in sorted(cited):
            if key not in keys:
                problems.append(f"{path}:{sources.line_of(text, offset)}: '{key}' is not in docs/references.bib")
        for match in NEAR_MISS.finditer(text):
            problems.append(f"{path}:{sources.line_of(text, match.start())}: write [key, eq. (5)] instead of {match.group(0)}")
    return problems, count


def check():
    keys, problems = read_bibliography((sources.ROOT / "docs/references.bib").read_text(encoding="utf-8"))
    texts = [(path, comments_only(text)) for path, text in sources.cpp_files()]
    for page in sorted(list(sources.ROOT.glob("*.md")) + list(sources.ROOT.glob("docs/**/*.md"))):
        texts.append((page.relative_to(sources.ROOT).as_posix(), page.read_text(encoding="utf-8")))
    found, count = find_problems(texts, keys)
    return sources.report("check_citations", problems + found, f"{count} citations of {len(keys)} works")


def self_test():
    keys, problems = read_bibliography("@book{known2008,\n  author = {A},\n  title = {T}\n}\n@misc{stepanyan,\n author = {S},\n title={D}\n}\n")
    assert keys == {"known2008", "stepanyan"} and not problems, problems
    assert read_bibliography("@misc{a,\n title = {T}\n}\n@misc{a,\n author = {A}\n}\n")[1] != []
    fine = "// [known2008, eq. (5)] [stepanyan, eqs. (6)-(9)] [stepanyan] [known2008] a[i] [0] [first, second] [index]\n"
    got, count = find_problems([("a.h", comments_only(fine))], keys)
    assert got == [] and count == 4, (got, count)
    for planted in ("// [unknown1999]", "/// [missing, eq. (5)]", "// [Stepanyan, (5)]", "// [stepanyan, (5)]", "// [Known 2008]",
                    "/* see\n [other2001, sec. 3] */"):
        got, _ = find_problems([("a.h", comments_only(planted + "\n"))], keys)
        assert len(got) == 1, (planted, got)
    assert find_problems([("a.cc", comments_only('auto s = "[unknown1999]";\n'))], keys)[0] == []


if __name__ == "__main__":
    sys.exit(sources.main("check_citations", check, self_test))
