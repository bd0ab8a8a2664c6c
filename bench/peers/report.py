"""Writes docs/speed.md and its plots from the results of a run: report.py RESULTS.json [DOCS]."""

import json
import math
import pathlib
import sys

NAMES = {"ferrers": "Ferrers", "floor": "floor", "mujoco4": "MuJoCo 4", "mujoco4-1": "MuJoCo 4, 3 rows a loop", "mujoco3": "MuJoCo 3",
         "mujoco2": "MuJoCo 2.2.2", "pinocchio4": "Pinocchio 4", "pinocchio3": "Pinocchio 3", "simbody": "Simbody", "drake": "Drake",
         "exudyn": "Exudyn"}
COLORS = {"ferrers": "#c0392b", "floor": "#888888", "mujoco4": "#1f5fa8", "mujoco3": "#6a9bd1", "mujoco2": "#a9c6e8", "pinocchio4": "#1e8449",
          "pinocchio3": "#7dcea0", "simbody": "#7d3c98", "drake": "#b7950b", "exudyn": "#935116"}
INK = "#222222"


def short(value):
    """Three digits, without a power of ten."""
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:.2g}" if value < 0.1 else f"{value:.3g}"


def error(value):
    return f"{value:.0e}".replace("e-0", "e-") if value else "0"


def cell(entry, kind):
    result = entry.get(kind) if entry else None
    if result:
        return f"{short(result['us'])} ({error(result['error'])})"
    return "–"


def peers(row):
    return [e for e in row if e not in ("ferrers", "floor", "mujoco4-1")]


def fastest_peer(row, kind, engines=None):
    found = [(row[e][kind]["us"], e) for e in engines or peers(row) if row[e].get(kind)]
    return min(found) if found else None


def table(header, rows):
    return ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] + ["| " + " | ".join(r) + " |" for r in rows] + [""]


def forward_table(results, key):
    titles, rows = results["titles"], []
    forward = results[key]
    engines = [e for e in NAMES if any(e in row for row in forward.values())]
    engines = [e for e in engines if any(row[e].get("any") for row in forward.values())]
    for scene, row in forward.items():
        rows.append([titles[scene]] + [cell(row.get(e), "any") for e in engines])
    return table(["µs (relative error)"] + [NAMES[e] for e in engines], rows)


def exact_table(results):
    titles, rows = results["titles"], []
    forward = results["forward"]
    engines = [e for e in NAMES if e in ("ferrers", "pinocchio4", "pinocchio3", "simbody") and any(e in r for r in forward.values())]
    for scene, row in forward.items():
        rows.append([titles[scene]] + [cell(row.get(e), "exact") for e in engines])
    return table(["µs (relative error)"] + [NAMES[e] for e in engines], rows)


def ratio_table(results):
    rows = []
    for scene, row in results["forward"].items():
        ours = row.get("ferrers", {}).get("any")
        if not ours:
            continue
        line = [results["titles"][scene]]
        for kind in ("any", "plausible", "close", "exact"):
            peer = fastest_peer(row, kind)
            line.append(f"{peer[0] / ours['us']:.3g}× ({NAMES[peer[1]]})" if peer else "no peer")
        floor = row.get("floor", {}).get("any")
        line.append(f"{ours['us'] / floor['us']:.3g}×" if floor else "")
        rows.append(line)
    return table(["faster than", "the fastest peer, any error", "the fastest with error ≤ 5e-2", "the fastest with error ≤ 1e-6", "the fastest with error ≤ 1e-8", "slower than the floor"], rows)


def load_table(results):
    rows = []
    for scene, row in results["forward"].items():
        line = [results["titles"][scene]]
        ours = row.get("ferrers", {}).get("any") or {}
        analyzed = results.get("analysis", {}).get(scene, {})
        line += [f"{1e3 * ours['load_s']:.3g}" if ours else "–", f"{1e3 * ours['decide_s']:.3g}" if ours else "–",
                 f"{1e3 * ours['compile_s']:.3g}" if ours.get("compile_s") else "–",
                 f"{1e3 * analyzed['analyze_s']:.3g}" if "analyze_s" in analyzed else analyzed.get("failed", "–"),
                 f"{ours['rss_kib'] / 1024:.3g}" if ours else "–"]
        for engine in ("mujoco4", "pinocchio4", "simbody"):
            other = row.get(engine, {}).get("any")
            line += [f"{1e3 * other['load_s']:.3g}" if other else "–",
                     f"{other['rss_kib'] / 1024:.3g}" if other and other.get("rss_kib") else "–"]
        rows.append(line)
    header = ["", "load, ms", "decide, ms", "native code, ms", "analyze, ms", "MiB", "MuJoCo load, ms", "MiB", "Pinocchio build, ms", "MiB", "Simbody build, ms", "MiB"]
    return table(header, rows)


def simulation_table(results, kind):
    rows = []
    engines = [e for e in NAMES if any(e in r["engines"] for r in results[kind].values())]
    for scene, row in results[kind].items():
        line = [f"{results['titles'][scene]}, {row['end']:g} s"]
        times = {}
        for engine in engines:
            found = row["engines"].get(engine, {}).get("found")
            if found:
                times[engine] = found["run_s"]
            line.append(f"{1e3 * found['run_s']:.3g}<br>{found['setting']}" if found else "none")
        others = [t for e, t in times.items() if e != "ferrers"]
        line.append(f"{min(others) / times['ferrers']:.3g}×" if others and "ferrers" in times else "–")
        rows.append(line)
    return table(["ms"] + [NAMES[e] for e in engines] + ["Ferrers faster"], rows)


def what_is_missing(results):
    lines = [f"- {what}: {why}" for what, why in results.get("problems", {}).items()]
    seen = {}
    for key in ("forward", "inverse"):
        for scene, row in results.get(key, {}).items():
            for engine, entry in row.items():
                if entry.get("any") or engine == "floor":
                    continue
                why = next((r["failed"] for r in entry["tried"] if "failed" in r), "no result")
                seen.setdefault((NAMES[engine], " ".join(why.split())), []).append(results["titles"][scene])
    return lines + [f"- {engine}, {', '.join(scenes)}: {why}" for (engine, why), scenes in seen.items()] + [""]


# ---- plots -----------------------------------------------------------------------------------------------------


def svg(width, height, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="sans-serif" font-size="13">\n<rect width="{width}" height="{height}" rx="6" fill="#ffffff"/>\n'
            + "\n".join(body) + "\n</svg>\n")


def text(x, y, words, anchor="middle", color=INK, size=13):
    return f'<text x="{x:.6g}" y="{y:.6g}" text-anchor="{anchor}" fill="{color}" font-size="{size}">{words}</text>'


def stroke(points, color, width=1.5, dash=""):
    path = "M" + "L".join(f"{x:.6g} {y:.6g}" for x, y in points)
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="{path}" stroke="{color}" stroke-width="{width}" fill="none"{dashed}/>'


def dot(x, y, color, hollow=False):
    return f'<circle cx="{x:.6g}" cy="{y:.6g}" r="4.5" fill="{"#ffffff" if hollow else color}" stroke="{color}" stroke-width="2"/>'


def power(exponent):
    return {0: "1 µs", 3: "1 ms", 6: "1 s"}.get(exponent, f"{10.0**exponent:g} µs" if exponent < 3 else f"{10.0**(exponent - 3):g} ms")


def key(engines, left, top):
    body = []
    for i, engine in enumerate(engines):
        y = top + 22 * i
        body += [dot(left, y, COLORS[engine]), text(left + 12, y + 4.5, NAMES[engine], "start")]
    return body + [dot(left, top + 22 * len(engines) + 4, INK, True), text(left + 12, top + 22 * len(engines) + 8.5, "error above 1e-8", "start")]


def dots(results):
    """Time per evaluation of every engine, mechanism by mechanism."""
    forward = results["forward"]
    engines = [e for e in COLORS if any(r.get(e, {}).get("any") for r in forward.values())]
    times = [r[e]["any"]["us"] for r in forward.values() for e in engines if r.get(e, {}).get("any")]
    low, high = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
    left, right, top, gap = 170, 760, 40, 30
    bottom = top + gap * len(forward)
    x = lambda us: left + (right - left) * (math.log10(us) - low) / (high - low)
    body = [text((left + right) / 2, 22, "forward dynamics, CPU time of one evaluation", size=14)]
    for k in range(low, high + 1):
        body += [stroke([(x(10.0**k), top), (x(10.0**k), bottom)], "#dddddd", 1), text(x(10.0**k), bottom + 18, power(k), size=12)]
    for i, (scene, row) in enumerate(forward.items()):
        y = top + gap * (i + 0.5)
        body += [text(left - 10, y + 4, results["titles"][scene], "end"), stroke([(left, y), (right, y)], "#eeeeee", 1)]
        for engine in reversed(engines):
            result = row.get(engine, {}).get("any")
            if result:
                body.append(dot(x(result["us"]), y, COLORS[engine], result["error"] > 1e-8))
    return svg(990, bottom + 35, body + key(engines, right + 40, top + 12))


def scale(results):
    """Time per evaluation against the number of four-bars."""
    forward = results["forward"]
    sizes = sorted((int(s[5:]), s) for s in forward if s.startswith("a02_n"))
    if len(sizes) < 2:
        return None
    curves = {}
    for engine in COLORS:
        points = [(n, forward[s][engine]["any"]) for n, s in sizes if forward[s].get(engine, {}).get("any")]
        if len(points) > 1:
            curves[engine] = points
    times = [p["us"] for points in curves.values() for _, p in points]
    low, high = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
    left, right, top, bottom, last = 80, 620, 40, 460, math.ceil(math.log10(sizes[-1][0]))
    x = lambda n: left + (right - left) * math.log10(n) / last
    y = lambda us: bottom - (bottom - top) * (math.log10(us) - low) / (high - low)
    body = [text((left + right) / 2, 22, "A02: chains of N four-bars, as drawn", size=14), text((left + right) / 2, bottom + 40, "N")]
    for k in range(low, high + 1):
        body += [stroke([(left, y(10.0**k)), (right, y(10.0**k))], "#dddddd", 1), text(left - 8, y(10.0**k) + 4, power(k), "end", size=12)]
    for k in range(last + 1):
        body.append(text(x(10.0**k), bottom + 18, f"{10**k:g}", size=12))
    for engine, points in curves.items():
        body.append(stroke([(x(n), y(p["us"])) for n, p in points], COLORS[engine]))
        body += [dot(x(n), y(p["us"]), COLORS[engine], p["error"] > 1e-8) for n, p in points]
    return svg(850, bottom + 55, body + key(list(curves), right + 40, top + 12))


def work_precision(results, scene):
    """Time of a whole run against the drift of its energy, every setting tried."""
    runs = {}
    for kind in ("simulations", "precise_simulations"):
        for engine, entry in results.get(kind, {}).get(scene, {}).get("engines", {}).items():
            tried = entry["tried"] if isinstance(entry["tried"], list) else []
            runs.setdefault(engine, []).extend((max(r["drift_J"], 1e-14), 1e6 * r["run_s"]) for r in tried
                                               if r.get("finished") and r.get("run_s") and r["angle_error"] < 0.1)
    runs = {engine: points for engine, points in runs.items() if points}
    if not runs:
        return None
    drifts = [d for points in runs.values() for d, _ in points]
    times = [t for points in runs.values() for _, t in points]
    first, last = math.floor(math.log10(min(drifts))), math.ceil(math.log10(max(drifts)))
    low, high = math.floor(math.log10(min(times))), math.ceil(math.log10(max(times)))
    left, right, top, bottom = 80, 620, 40, 460
    x = lambda drift: left + (right - left) * (math.log10(drift) - first) / (last - first)
    y = lambda us: bottom - (bottom - top) * (math.log10(us) - low) / (high - low)
    body = [text((left + right) / 2, 22, f"{results['titles'][scene]}: time of a run against what its energy drifts", size=14),
            text((left + right) / 2, bottom + 40, "J")]
    for k in range(low, high + 1):
        body += [stroke([(left, y(10.0**k)), (right, y(10.0**k))], "#dddddd", 1), text(left - 8, y(10.0**k) + 4, power(k), "end", size=12)]
    for k in range(first, last + 1, 2):
        body.append(text(x(10.0**k), bottom + 18, f"1e{k}", size=12))
    for engine, points in runs.items():
        body += [dot(x(drift), y(us), COLORS[engine]) for drift, us in points]
    engines = list(runs)
    legend = [part for i, engine in enumerate(engines) for part in
              (dot(right + 40, top + 12 + 22 * i, COLORS[engine]), text(right + 52, top + 16.5 + 22 * i, NAMES[engine], "start"))]
    return svg(850, bottom + 55, body + legend)


# ---- the page --------------------------------------------------------------------------------------------------

HEAD = """# Speed

Ferrers beside the engines that one would take instead: the same mechanisms, the same states, the errors shown, on
one machine. This page is written by `./run bench peers`; the programs are in `bench/peers`.

- Every mechanism is defined once (`bench/peers/mechanisms.py`) and handed to every engine with all rows as drawn: spatial
  hinges also where a mechanism is planar. Loops are cut at the same joints for all that need it cut.
- Times are CPU time per evaluation on one thread, the least over many batches and rounds in which the engines take turns;
  each evaluation starts from another of four states (one for N = 1,000), so that nothing is remembered.
- The error is that of the joint accelerations against accelerations computed without any engine (absolute coordinates,
  singular vectors, closed forms; good to 1e-12), relative to the largest, the worst of the states.
- An engine is shown with the fastest of all settings tried, its error beside it, however large; the table after it shows
  the fastest setting with an error of at most 1e-8.
- The floor is written by hand for the planar four-bars: one coordinate, and all planar joint forces.

MuJoCo keeps loops softly, by stiff constraint forces: two connected points of the axis for a hinge that closes a loop.
Pinocchio holds the same two points by proximal iterations, through the factors of the whole system (exact) or by a
recursion along tree and loops, whose error depends on its damping. Simbody solves five rows a hinge by least squares.
Ferrers runs native code of the mechanism (`docs/forward-dynamics.md`), made once; the last table tells what that takes.
Drake has loops only in its discrete solver (no centrifugal terms in its rows, hence its error), called from Python, an
empty call subtracted. Exudyn's figure is a whole step of its implicit integrator in absolute coordinates.
"""


def write(results, docs):
    docs = pathlib.Path(docs)
    (docs / "img").mkdir(parents=True, exist_ok=True)
    m = results["machine"]
    page = [HEAD, f"Measured {results['date']} on {m['cpu']}, {m['cores']} cores, {m['compiler']}; load average at the start "
            f"{m['load_average'][0]}, at the end {m['load_average_end'][0]} (other work shared the cores where it is above 1).", ""]
    runs = {}
    for engine, at in results.get("measured_at", {}).items():
        runs.setdefault(at, []).append(NAMES[engine])
    if len(runs) > 1:
        page += ["Not all in one run: " + "; ".join(f"{', '.join(names)} at {at.replace('T', ' ')}" for at, names in sorted(runs.items()))
                 + ".", ""]
    page += [line for remark in results.get("remarks", []) for line in (remark, "")]
    versions = sorted({(NAMES[e], r["version"]) for row in results["forward"].values() for e, entry in row.items()
                       for r in entry["tried"] if r.get("version")})
    page += ["Versions: " + ", ".join(f"{name} = {version}" for name, version in versions) + ".", ""]
    page += ["## Forward dynamics with multipliers", "", "![](img/speed-evaluation.svg)", "", *forward_table(results, "forward"),
             "The fastest settings with a relative error of at most 1e-8:", "", *exact_table(results), *ratio_table(results)]
    (docs / "img" / "speed-evaluation.svg").write_text(dots(results), encoding="utf-8")
    drawn = scale(results)
    if drawn:
        (docs / "img" / "speed-scale.svg").write_text(drawn, encoding="utf-8")
        page += ["![](img/speed-scale.svg)", ""]
    if results.get("inverse"):
        page += ["## Inverse dynamics of open trees", "", *forward_table(results, "inverse")]
    if results.get("simulations"):
        page += ["## Whole simulations", "",
                 "The cheapest run whose energy drifts by at most 1e-4 of the largest kinetic energy and whose last angle is within "
                 "1e-2 rad, steps and tolerances scanned:", "", *simulation_table(results, "simulations")]
    if results.get("precise_simulations"):
        page += ["The same with a drift of at most 1e-9 J:", "", *simulation_table(results, "precise_simulations")]
    drawn = work_precision(results, "bricard")
    if drawn:
        (docs / "img" / "speed-work-precision.svg").write_text(drawn, encoding="utf-8")
        page += ["Every run that was scanned on the way, ten seconds of Bricard's mechanism:", "",
                 "![](img/speed-work-precision.svg)", ""]
    page += ["## Loading and memory", "", "Ferrers' and MuJoCo's files are read and laid out; Pinocchio's and Simbody's models are built by "
             "calls. Memory is the peak of the process.", "", *load_table(results)]
    page += ["## What is missing, and why", "", *what_is_missing(results)]
    text_of_page = "\n".join(page).rstrip() + "\n"
    (docs / "speed.md").write_text(text_of_page, encoding="utf-8")


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        write(json.load(file), sys.argv[2] if len(sys.argv) > 2 else "docs")
