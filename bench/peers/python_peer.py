"""What the programs in Python share: the clock, the overhead of a call, and the line that each prints."""

import json
import time


def least_microseconds(evaluate, states, seconds):
    """Least CPU time of evaluate(i) in µs over short batches, all states in turn."""
    rounds = 1

    def batch(count):
        start = time.process_time()
        for _ in range(count):
            for i in range(states):
                evaluate(i)
        return time.process_time() - start

    while batch(rounds) < 5e-3 and rounds < 1 << 20:
        rounds *= 2
    least, start = float("inf"), time.process_time()
    while True:
        least = min(least, batch(rounds))
        if time.process_time() - start >= seconds:
            return 1e6 * least / rounds / states


def setting(arguments, name, otherwise):
    for argument in arguments:
        if argument.startswith(name + "="):
            return argument[len(name) + 1:]
    return otherwise


def finish(main):
    """Prints what `main` returns, or why it fails."""
    try:
        out = main()
    except Exception as problem:  # a peer that fails is told by name, whatever the reason
        out = {"failed": f"{type(problem).__name__}: {str(problem).splitlines()[0] if str(problem) else ''}"}
    with open("/proc/self/status", encoding="utf-8") as status:
        out["rss_kib"] = next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    print(json.dumps(out))
