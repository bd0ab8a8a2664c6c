#!/usr/bin/env python3
"""Two threads of one batch beside two processes with a batch each: what sharing costs.

    bench/processes.py --program build/bench/bin/batch_bench [--output FILE.json]
"""

import argparse
import datetime
import json
import pathlib
import re
import subprocess
import sys

MECHANISMS = ["bricard_a04", "four_bar", "three_cranks", "n_four_bar_a02/10"]


def start(program, name):
    command = [program, f"--benchmark_filter=^{re.escape(name)}/", "--benchmark_format=json", "--benchmark_min_time=1"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def states_per_second(process):
    return json.loads(process.communicate()[0])["benchmarks"][0]["items_per_second"]


def measure(program, mechanism, rounds):
    one = both = apart = 0
    for _ in range(rounds):
        one = max(one, states_per_second(start(program, f"batch/{mechanism}")))
        both = max(both, states_per_second(start(program, f"batch_2_threads/{mechanism}")))
        apart = max(apart, sum(states_per_second(p) for p in [start(program, f"batch/{mechanism}") for _ in range(2)]))
    return {"one thread": one, "two threads": both, "two processes": apart, "threads over processes": both / apart}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--output", type=pathlib.Path)
    options = parser.parse_args()
    record = {"date": datetime.date.today().isoformat(), "states per second": {}}
    for mechanism in MECHANISMS:
        row = measure(options.program, mechanism, options.rounds)
        record["states per second"][mechanism] = row
        print(mechanism, "  ".join(f"{what} {value:.3g}" for what, value in row.items()), flush=True)
    if options.output:
        options.output.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
