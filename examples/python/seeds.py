"""The number of 20 seeds that succeed, as in the compiled examples; the argument sets another number of seeds."""

import sys

SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 20


def succeeded(run):
    return sum(bool(run(seed)) for seed in range(SEEDS))


def report(what, mppi, svg_mppi, required, compare=False):
    """Prints the figures and fails unless svg_mppi succeeds for `required` of 20 seeds."""
    print(f"{what}: mppi {mppi} of {SEEDS} seeds, svg_mppi {svg_mppi} of {SEEDS}")
    if svg_mppi < required * SEEDS / 20 or (compare and svg_mppi < mppi):
        sys.exit(1)
