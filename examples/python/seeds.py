"""How many seeds succeed: 20 as in the compiled examples, fewer where a run takes long."""

import sys


def succeeded(run, seeds=20):
    return sum(bool(run(seed)) for seed in range(seeds))


def report(what, mppi, svg_mppi, required, seeds=20, compare=False):
    print(f"{what}: mppi {mppi} of {seeds} seeds, svg_mppi {svg_mppi} of {seeds}")
    if svg_mppi < required or (compare and svg_mppi < mppi):
        sys.exit(1)
