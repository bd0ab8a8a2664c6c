#!/usr/bin/env python3
"""Measures Ferrers and its peers side by side: run.py --ferrers PROGRAM [--rounds N] [--seconds S] [--only SCENE,...]
[--engines ENGINE,...] [--no-simulations] [--output FILE.json] [--update]. `./run bench peers` calls it.

Forward dynamics: every setting of every engine once on every scene; then each engine's best settings again, engine
after engine, as many rounds as asked for, so that all of them meet the same disturbances. The least time counts.
Simulations: bench/peers/simulations.py. Results go to bench/history and docs/speed.md (bench/peers/report.py).
"""

import argparse
import datetime
import json
import os
import pathlib
import platform
import re
import subprocess
import sys

import build

SCENES = build.FOLDER / "scenes"
LONGEST = 60  # seconds that one program may take
# The fastest setting with a relative error of the accelerations of at most so much.
LIMITS = {"any": float("inf"), "plausible": 0.05, "close": 1e-6, "exact": 1e-8}


def machine():
    cpu = re.search(r"model name\s*:\s*(.*)", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    compiler = subprocess.run([os.environ.get("CXX", "g++"), "--version"], capture_output=True, text=True, check=False)
    return {"cpu": cpu.group(1) if cpu else platform.processor(), "cores": os.cpu_count(),
            "load_average": [round(x, 2) for x in os.getloadavg()], "compiler": build.last_line(compiler.stdout.splitlines()[0])}


def machine_name(told):
    return re.sub(r"[^a-z0-9]+", "-", f"{told['cpu']} {told['cores']} cores".lower()).strip("-")


def variants(engine, scene, ferrers):
    """[(setting in words, command before SCENE.json SECONDS, arguments after)] of an engine."""
    programs = build.FOLDER / "bin"
    python = [build.venv_python(), "-W", "ignore"]
    tree = scene in ("arm_7", "humanoid")
    if engine == "ferrers":
        return [("recommended", [ferrers], [f"model={SCENES / scene}.yaml"])]
    if engine == "floor":
        return [("by hand", [programs / "floor_peer"], [])]
    if engine.startswith("mujoco"):
        series = engine[len("mujoco"):][0]
        points = "-1" if engine.endswith("-1") else ""
        listed = []
        for solver in ("newton",) if tree else ("newton", "cg"):
            for jacobian in ("dense", "sparse"):
                if jacobian == "dense" and scene == "a02_n1000":
                    continue
                listed.append((f"{solver}, {jacobian}", [programs / f"mujoco_peer_{series}"],
                               [f"model={SCENES / scene}{points}.xml", f"solver={solver}", f"jacobian={jacobian}"]))
        return listed
    if engine.startswith("pinocchio"):
        kinds = [("", f"pinocchio_peer_{engine[-1]}")] + ([(", AVX2", "pinocchio_peer_4_avx2")] if engine[-1] == "4" else [])
        kinds = [(words, name) for words, name in kinds if (programs / name).exists()] or kinds[:1]
        if tree:
            settings = [[f"algorithm={a}"] for a in ("aba-local", "aba-world")]
        else:
            settings = [["algorithm=cholesky", f"mu={mu}", "iterations=2"] for mu in ("1e-8",)]
            if engine[-1] == "4":
                settings += [["algorithm=lcaba", f"mu={mu}", f"iterations={n}"]
                             for mu, n in (("1e-8", 1), ("1e-6", 2), ("1e-5", 2), ("1e-5", 3), ("1e-4", 3), ("1e-4", 5), ("1e-4", 10))]
        return [(" ".join(s) + words, [programs / name], s) for words, name in kinds for s in settings
                if not (scene == "a02_n1000" and "algorithm=cholesky" in s)]
    if engine == "simbody":
        return [("multibody tree", [programs / "simbody_peer"], [])]
    if engine == "drake":
        words = "continuous" if tree else "SAP, step 1e-4 s"
        return [(words, [*python, build.SOURCES / "drake_peer.py"], [])]
    return [("generalized alpha, a step", [*python, build.SOURCES / "exudyn_peer.py"], [])]


ENGINES = ["ferrers", "floor", "mujoco4", "mujoco4-1", "mujoco3", "mujoco2", "pinocchio4", "pinocchio3", "simbody", "drake",
           "exudyn"]


def measure(command, scene, seconds, arguments, longest=LONGEST):
    """What the program prints, or {"failed": why}."""
    scene_file = scene if "exudyn" in str(command[-1]) else SCENES / f"{scene}.json"
    line = [str(x) for x in [*command, scene_file, seconds, *arguments]]
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1", PYTHONDONTWRITEBYTECODE="1")
    try:
        done = subprocess.run(line, capture_output=True, text=True, timeout=longest, env=environment, check=False)
        return json.loads(done.stdout.strip().splitlines()[-1])
    except subprocess.TimeoutExpired:
        return {"failed": f"not done after {longest} s"}
    except FileNotFoundError:
        return {"failed": "not built"}
    except (IndexError, ValueError):
        return {"failed": build.last_line(done.stderr) if done.stderr.strip() else f"ended with code {done.returncode}"}


def best(results, limit):
    good = [r for r in results if "us" in r and r["error"] is not None and r["error"] <= limit]
    return min(good, key=lambda r: r["us"]) if good else None


def forward(names, engines, options, keep, mode="forward"):
    """{scene: {engine: {"tried": all settings, and for each of LIMITS the fastest within it}}}."""
    table = {}
    for scene in names:
        row = {}
        for engine in engines:
            tried = []
            for words, command, arguments in variants(engine, scene, options.ferrers):
                result = measure(command, scene, min(options.seconds, 0.1), [*arguments, f"mode={mode}"])
                result.update(setting=words, command=[str(x) for x in command], arguments=arguments)
                tried.append(result)
                if "not built" == result.get("failed"):
                    break
            if not tried:
                tried.append({"failed": "its one algorithm has dense factors of thousands of rows; 100 four-bars take 0.02 s"})
            row[engine] = {"tried": tried}
        again = {}
        for engine, entry in row.items():
            for limit in LIMITS.values():
                chosen = best(entry["tried"], limit)
                if chosen:
                    again[(engine, chosen["setting"])] = chosen
        for _ in range(options.rounds):
            for chosen in again.values():
                result = measure(chosen["command"], scene, options.seconds, [*chosen["arguments"], f"mode={mode}"])
                if "us" in result:
                    chosen["us"] = min(chosen["us"], result["us"])
                    chosen["load_s"] = min(chosen.get("load_s", 1e9), result.get("load_s", 1e9))
        for engine, entry in row.items():
            for kind, limit in LIMITS.items():
                entry[kind] = best(entry["tried"], limit)
            for r in entry["tried"]:
                for key in ("command", "arguments"):
                    r.pop(key, None)
            shown = entry["any"]
            print(f"{scene:14} {mode:8} {engine:11} " + (f"{shown['us']:10.3f} us  error {shown['error']:.1e}  {shown['setting']}"
                  if shown else entry["tried"][-1].get("failed", "no result")), flush=True)
        table[scene] = row
        keep({"forward": table} if mode == "forward" else {"inverse": table})
    return table


def analysis(names, options):
    """Time to read, lay out and decide, and to answer all questions; of ours alone."""
    table = {}
    for scene in names:
        longest = 120 if scene == "a02_n1000" else LONGEST
        result = measure([options.ferrers], scene, 0, [f"model={SCENES / scene}.yaml", "mode=analyze"], longest)
        table[scene] = result
        print(f"{scene:14} analyze  ferrers     {result}", flush=True)
    return table


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ferrers", default=str(build.ROOT / "build" / "bench" / "bin" / "ferrers_peer"))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=0.3)
    parser.add_argument("--only", default="")
    parser.add_argument("--engines", default="")
    parser.add_argument("--no-simulations", action="store_true")
    parser.add_argument("--no-forward", action="store_true")
    parser.add_argument("--output", default="")
    parser.add_argument("--update", action="store_true")
    return parser.parse_args()


def in_venv():
    """Goes on in the environment that has numpy and the packages."""
    problems = {}
    build.get_packages(problems)
    build.build_programs(problems)
    for what, problem in problems.items():
        print(f"{what}: {problem}", flush=True)
    os.environ["PEERS_PROBLEMS"] = json.dumps(problems)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    os.execv(str(build.venv_python()), [str(build.venv_python()), *sys.argv])


def in_lines(results):
    """JSON with one result a line."""
    text = json.dumps(results, indent=1)
    for kind in (r"\{[^{}\[\]]*\}", r"\[[^{}\[\]]*\]", r"\{[^{}]*\}"):
        text = re.sub(kind, lambda found: " ".join(found.group(0).split()), text)
    return text + "\n"


def merged(old, new):
    """`new` over `old`: maps of maps are joined, anything else is replaced."""
    if not (isinstance(old, dict) and isinstance(new, dict)):
        return new
    replaced = {"tried", "machine", "problems"}
    return {k: merged(old[k], new[k]) if k in old and k in new and k not in replaced else new.get(k, old.get(k)) for k in {**old, **new}}


def main():
    options = arguments()
    if pathlib.Path(sys.prefix).resolve() != (build.FOLDER / "venv").resolve():
        in_venv()
    import emit
    import mechanisms
    import reference
    import report
    import simulations

    scenes = [s for s in mechanisms.all_scenes() if not options.only or s.name in options.only.split(",")]
    engines = [e for e in ENGINES if not options.engines or e in options.engines.split(",")]
    checks = reference.self_test(mechanisms.all_scenes())
    worst = max(error for *_, error in checks)
    if worst > 1e-11:
        sys.exit(f"the reference accelerations are wrong: {checks}")
    names = emit.emit(scenes, SCENES)
    results = {"date": datetime.date.today().isoformat(), "machine": machine(), "seconds": options.seconds,
               "rounds": options.rounds, "titles": {s.name: s.title for s in scenes}, "reference_error": worst,
               "problems": json.loads(os.environ.get("PEERS_PROBLEMS", "{}"))}
    name = options.output or build.ROOT / "bench" / "history" / f"{results['date']}-{machine_name(results['machine'])}.json"
    name = pathlib.Path(name)
    name.parent.mkdir(parents=True, exist_ok=True)

    results["measured_at"] = {e: datetime.datetime.now().isoformat(timespec="minutes") for e in engines}
    before = json.loads(name.read_text(encoding="utf-8")) if options.update and name.exists() else {}
    results["titles"] = {**before.get("titles", {}), **results["titles"]}

    def keep(part=None):
        results.update(part or {})
        results["machine"]["load_average_end"] = [round(x, 2) for x in os.getloadavg()]
        whole = merged(before, results)
        name.write_text(in_lines(whole), encoding="utf-8")

    if not options.no_forward:
        results["forward"] = forward(names, engines, options, keep)
        keep()
        trees = [n for n in names if n in ("arm_7", "humanoid")]
        inverse = [e for e in engines if e in ("ferrers", "mujoco4", "mujoco3", "pinocchio4", "pinocchio3", "drake")]
        results["inverse"] = forward(trees, inverse, options, keep, "inverse")
        if "ferrers" in engines:
            results["analysis"] = analysis(names, options)
        keep()
    if not options.no_simulations:
        for kind, level in simulations.LEVELS.items():
            results[kind] = simulations.all_runs(scenes, engines, level, options, measure)
            keep()
    print(f"results: {name}")
    if not options.output and not options.only and not options.engines:
        report.write(merged(before, results), build.ROOT / "docs")


if __name__ == "__main__":
    main()
