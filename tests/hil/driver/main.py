"""Boots the guest, installs the package and runs the scenarios; says for each how it went."""
import argparse
import resource
import sys
import time
import traceback

import device_scenarios
import service_scenarios
from box import Box
from machine import Failure, Machine
from pictures import TowerClip


def run_all(box, names):
    """The names of the scenarios that failed. Each finds the box as the one before left it; the first two always run."""
    failed = []
    for scenario in service_scenarios.FIRST + device_scenarios.ALL + service_scenarios.LAST:
        name = scenario.__name__
        if names and name not in names and scenario not in service_scenarios.FIRST[:2]:
            continue
        begin = time.monotonic()
        try:
            scenario(box)
            outcome = "ok"
        except Exception as error:  # the next scenario may tell more
            failed.append(name)
            outcome = f"FAILED: {error}"
            box.keep_screen(f"failed_{name}")
            if not isinstance(error, Failure):
                traceback.print_exc()
            print(box.explain())
        print(f"[{time.monotonic() - begin:6.1f} s] {name}: {outcome}")
    return failed


def main():
    parser = argparse.ArgumentParser()
    for option in ("image", "payload", "clip", "out"):
        parser.add_argument(f"--{option}", required=True)
    parser.add_argument("scenarios", nargs="*")
    options = parser.parse_args()
    begin = time.monotonic()
    machine = Machine(options.image, options.payload, options.out)
    try:
        box = Box(machine, TowerClip(options.clip, 640, 480), options.out)
        failed = run_all(box, options.scenarios)
    finally:
        machine.stop()
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"[{time.monotonic() - begin:6.1f} s] in all, {usage.ru_utime + usage.ru_stime:.0f} s of processor; failed: {', '.join(failed) or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
