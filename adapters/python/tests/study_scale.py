"""Measures what a study costs beside its runs on a Dask cluster of this machine, and simulates up to 64 workers with it.

usage: study_scale.py FOLDER SECONDS_OF_A_LAP..., the times of some laps
"""

import heapq
import os
import sys
import time
from itertools import cycle
from pathlib import Path

import distributed
import numpy as np
import study_faults as faults
from slalom import study


def waits(seed, seconds=0.0):
    return time.sleep(seconds) or seed


def processor_time(process):  # s
    return sum(map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13])) / os.sysconf("SC_CLK_TCK")


def efficiency(workers, laps, cost, count, seconds=5.0):
    """Runs' time over workers' time, with the tasks of a study: each takes `cost` s of study and scheduler, one at a time."""
    left, spent, ran, free, ends, runs = count, 0.0, 0, 0.0, [(0.0, 0.0, 0)] * workers, cycle(laps)
    while left:
        end, took, size = heapq.heappop(ends)
        spent, ran = spent + took, ran + size
        size = max(1, min(int(seconds * ran / spent) if spent else 1, left // (2 * workers + 2), left))
        free, took, left = max(end, free) + cost, sum(next(runs) for _ in range(size)), left - size
        heapq.heappush(ends, (max(end, free) + took, took, size))
    return sum(x for x, _ in zip(cycle(laps), range(count))) / (workers * max(end for end, _, _ in ends))


def main():
    laps = [float(word) for word in sys.argv[2:]]
    with faults.Cluster() as cluster, distributed.Client(cluster.address, timeout=120, set_as_default=False) as client:
        client.wait_for_workers(2)
        processes = [os.getpid(), cluster.scheduler.pid, *(each.pid for each in cluster.workers)]
        for name, seconds, count in (("first tasks", 0, 20), ("tasks without work", 0, 400), ("tasks of 1 s", 1, 40)):
            before, begin = [processor_time(each) for each in processes], time.monotonic()
            made = study.Function(f"{sys.argv[1]}/{name}", function=waits, seeds=count, set=[f"seconds={seconds}"])
            list(study.run(made, client, seconds=seconds, quiet=True))
            costs = [1e3 * (processor_time(each) - b) / count for each, b in zip(processes, before)]
            print(f"{count} {name}: {time.monotonic() - begin:.2f} s; processor time of a task: {np.round(costs, 1)} ms: study, scheduler, workers")
            cost = (costs[0] + costs[1]) / 1e3 if not seconds else cost
    for workers in (1, 2, 4, 8, 16, 32, 64):
        print(f"{workers} workers: efficiency {100 * efficiency(workers, laps, cost, 10000):.1f} %")


main()
