#!/usr/bin/env python3
"""Nests strip instances with spyrrow (pip install spyrrow) and with furbelow at equal CPU seconds on one core, and prints both densities.

    python3 benches/nest/beside_spyrrow.py --furbelow target/release/furbelow --seconds 20 FILE.json ...

spyrrow goes first, because it watches the clock: one worker, no early termination, so many seconds. furbelow, whose search is counted and not timed, then
gets the effort that takes as many CPU seconds as spyrrow used, as a short run tells. Both count all they do, reading included. Without spyrrow only
furbelow's rows appear.
"""

import argparse
import json
import os
import resource
import subprocess
import sys

# The run that tells how fast lines are looked along.
TRIAL_EFFORT = 100_000


def outline(shape):
    data = shape["data"]
    if shape["type"] == "rectangle":
        x, y, w, h = (data[k] for k in ("x_min", "y_min", "width", "height"))
        data = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    elif shape["type"] == "polygon":
        data = data["outer"]
    return data if data[0] == data[-1] else data + [data[0]]


def angles(item):
    if "allowed_orientations" in item:
        return item["allowed_orientations"]
    return item.get("orientation", {}).get("rotation", {}).get("angles", [0.0])


def timed(command):
    """What a command prints as JSON, and the CPU seconds it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    printed = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return json.loads(printed), after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def with_furbelow(binary, file, effort, seed):
    answer, used = timed([binary, "nest", file, "--json", "--effort", str(effort), "--seed", str(seed)])
    return 100 * answer["density"], answer["length_mm"], used


def with_spyrrow(file, seconds, seed):
    answer, used = timed([sys.executable, __file__, "--spyrrow-only", "--seconds", str(seconds), "--seed", str(seed), file])
    return 100 * answer["density"], answer["length"], used


def spyrrow_only(file, seconds, seed):
    """In a process of its own, so that its CPU seconds are its own."""
    import spyrrow

    with open(file) as text:
        instance = json.load(text)
    items = [
        spyrrow.Item(str(i["id"]), [tuple(p) for p in outline(i["shape"])], i["demand"], angles(i)) for i in instance["items"]
    ]
    strip = spyrrow.StripPackingInstance(instance["name"], instance["strip_height"], items)
    config = spyrrow.StripPackingConfig(
        early_termination=False, total_computation_time=max(1, round(seconds)), num_workers=1, seed=seed
    )
    solution = strip.solve(config)
    print(json.dumps({"density": solution.density, "length": solution.width}))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", help="strip instances, jagua-rs or ESICUP JSON")
    parser.add_argument("--furbelow", default="target/release/furbelow", help="the program to measure")
    parser.add_argument("--seconds", type=float, default=20.0, help="what spyrrow gets, by the clock")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--core", type=int, help="run everything on this core (Linux)")
    parser.add_argument("--spyrrow-only", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.spyrrow_only:
        return spyrrow_only(given.files[0], given.seconds, given.seed)
    if given.core is not None:
        os.sched_setaffinity(0, {given.core})
    try:
        import spyrrow as _

        beside = True
    except ImportError:
        beside = False
        print("spyrrow is not installed (pip install spyrrow): furbelow alone", file=sys.stderr)
    print(f"{'instance':<12}{'spyrrow %':>10}{'length':>9}{'CPU s':>7}{'furbelow %':>12}{'length':>9}{'CPU s':>7}{'points':>8}")
    for file in given.files:
        with open(file) as text:
            name = json.load(text)["name"]
        other = with_spyrrow(file, given.seconds, given.seed) if beside else None
        budget = other[2] if other else given.seconds
        _, _, trial = with_furbelow(given.furbelow, file, TRIAL_EFFORT, given.seed)
        effort = round(TRIAL_EFFORT * budget / trial)
        own = with_furbelow(given.furbelow, file, effort, given.seed)
        left = "{:>10.2f}{:>9.1f}{:>7.1f}".format(*other) if other else f"{'-':>10}{'-':>9}{'-':>7}"
        right = "{:>12.2f}{:>9.1f}{:>7.1f}".format(*own)
        print(f"{name:<12}{left}{right}" + (f"{own[0] - other[0]:>+8.2f}" if other else ""), flush=True)


if __name__ == "__main__":
    main()
