"""Measures what a study costs beside its runs on a Dask cluster of this machine, drives laps with one worker and with two, and
simulates up to 64 workers with the times of these tasks.

usage: study_scale.py FOLDER [OPTION=VALUE of slalom eval]...
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


def timed(call, *arguments):
    begin = time.monotonic()
    return [*call(*arguments), time.monotonic() - begin]


class Timed(study.Laps):
    """Laps that keep the times of their tasks."""

    def work(self, runs):
        return (timed, *super().work(runs))

    def lines(self, runs, outputs):
        self.tasks = [*getattr(self, "tasks", []), (len(runs), outputs.pop())]
        return super().lines(runs, outputs)


def processor_time(process):  # s
    return sum(map(int, Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13])) / os.sysconf("SC_CLK_TCK")


def efficiency(workers, laps, cost, count, seconds=5.0):
    """Tasks' time over workers' time: each task takes `cost` s of study and scheduler, one at a time."""
    left, spent, ran, free, ends, runs = count, 0.0, 0, 0.0, [(0.0, 0.0, 0)] * workers, cycle(laps)
    while left:
        end, took, size = heapq.heappop(ends)
        spent, ran = spent + took, ran + size
        size = max(1, min(int(seconds * ran / spent) if spent else 1, left // (2 * workers + 2), left))
        free, took, left = max(end, free) + cost, sum(next(runs) for _ in range(size)), left - size
        heapq.heappush(ends, (max(end, free) + took, took, size))
    return sum(x for x, _ in zip(cycle(laps), range(count))) / (workers * max(end for end, _, _ in ends))


def drive(made, workers, seconds):
    """The wall time of a study, and the processor times of study, scheduler and workers."""
    with faults.Cluster(workers) as cluster, distributed.Client(cluster.address, timeout=120, set_as_default=False) as client:
        client.wait_for_workers(workers)
        processes = [os.getpid(), cluster.scheduler.pid, *(each.pid for each in cluster.workers)]
        before, begin = [processor_time(each) for each in processes], time.monotonic()
        list(study.run(made, client, seconds=seconds, quiet=True))
        return time.monotonic() - begin, [processor_time(each) - b for each, b in zip(processes, before)]


def main(folder, *options):
    for name, seconds, count in ("first tasks", 0, 20), ("tasks without work", 0, 200), ("tasks of 1 s", 1, 40):
        made = study.Function(f"{folder}/{name}", function=waits, seeds=count, set=[f"seconds={seconds}"])
        wall, costs = drive(made, 2, seconds)
        print(f"{count} {name}: {wall:.2f} s; processor time of a task: {np.round(1e3 * np.array(costs) / count, 1)} ms: study, scheduler, workers")
        cost = (costs[0] + costs[1]) / count if not seconds else cost
    for workers in 1, 2:
        made = Timed(f"{folder}/{workers}", **dict(each.split("=") for each in options))
        wall, busy, laps = drive(made, workers, 5)[0], sum(took for _, took in made.tasks), len(made.runs)
        print(f"{workers} workers, measured: {laps} laps in {len(made.tasks)} tasks of {busy / laps:.2f} s a lap, {wall:.1f} s: "
              f"efficiency {100 * busy / workers / wall:.1f} %")
    times = [took / size for size, took in made.tasks for _ in range(size)]
    for workers in (1, 2, 4, 8, 16, 32, 64):
        print(f"{workers} workers, simulated: efficiency {100 * efficiency(workers, times, cost, 10000):.1f} %")


main(*sys.argv[1:])
