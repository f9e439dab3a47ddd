"""The number of seeds that succeed; the argument sets the number of seeds, 3 by default."""

import sys

SEEDS = int(sys.argv[1]) if len(sys.argv) > 1 else 3


def succeeded(name, run):
    """Calls `run` with every seed and prints whether it returns true."""
    count = 0
    for seed in range(SEEDS):
        success = bool(run(seed))
        print(f"{name}, seed {seed}: {'yes' if success else 'no'}", flush=True)
        count += success
    return count


def report(what, mppi, svg_mppi, required, compare=False):
    """Prints the figures and fails unless svg_mppi succeeds for `required` of 20 seeds."""
    print(f"{what}: mppi {mppi} of {SEEDS} seeds, svg_mppi {svg_mppi} of {SEEDS}")
    if svg_mppi < required * SEEDS / 20 or (compare and svg_mppi < mppi):
        sys.exit(1)
