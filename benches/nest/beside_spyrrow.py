#!/usr/bin/env python3
"""Nests strip instances with furbelow and with spyrrow (pip install spyrrow) at equal CPU seconds, and prints both densities.

    python3 benches/nest/beside_spyrrow.py --furbelow target/release/furbelow --effort 1000000 FILE.json ...

furbelow goes first; spyrrow then gets as many seconds as furbelow used of the processor, on one worker, without early termination. On a busy machine
spyrrow, which watches the clock, gets less of the processor than that: its own CPU seconds are printed too. Without spyrrow only furbelow's rows appear.
"""

import argparse
import json
import resource
import subprocess
import sys


def cpu(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


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


def with_furbelow(binary, file, effort, seed):
    before = cpu(resource.RUSAGE_CHILDREN)
    command = [binary, "nest", file, "--json", "--effort", str(effort), "--seed", str(seed)]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return answer, cpu(resource.RUSAGE_CHILDREN) - before


def with_spyrrow(instance, seconds, seed):
    try:
        import spyrrow
    except ImportError:
        return None
    items = [
        spyrrow.Item(str(i["id"]), [tuple(p) for p in outline(i["shape"])], i["demand"], angles(i)) for i in instance["items"]
    ]
    strip = spyrrow.StripPackingInstance(instance["name"], instance["strip_height"], items)
    settings = spyrrow.StripPackingConfig(
        early_termination=False, total_computation_time=max(1, round(seconds)), num_workers=1, seed=seed
    )
    before = cpu(resource.RUSAGE_SELF)
    solution = strip.solve(settings)
    return solution.density, cpu(resource.RUSAGE_SELF) - before


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--furbelow", default="target/release/furbelow")
    parser.add_argument("--effort", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    print(f"{'instance':<16}{'furbelow %':>12}{'CPU s':>8}{'spyrrow %':>12}{'CPU s':>8}")
    for file in given.files:
        with open(file) as text:
            instance = json.load(text)
        answer, used = with_furbelow(given.furbelow, file, given.effort, given.seed)
        row = f"{instance['name']:<16}{100 * answer['density']:>12.2f}{used:>8.1f}"
        other = with_spyrrow(instance, used, given.seed) if "strip_height" in instance else None
        print(row + (f"{100 * other[0]:>12.2f}{other[1]:>8.1f}" if other else f"{'-':>12}{'-':>8}"))
        sys.stdout.flush()


if __name__ == "__main__":
    main()
