"""Drives a study on a Dask cluster of this machine: a worker is killed, then the scheduler, then the study, which is resumed.
The folder must be that of `slalom eval` alone, byte for byte but for clock times.

usage: study_faults.py FOLDER LAPS TIMES
"""

import csv
import os
import random
import re
import subprocess
import sys
import time
from pathlib import Path

from slalom import study

CLOCK = re.compile(r"solve_.*|wall_time|tracking_update_p99|update_.*_ms|checksum")
WORLD = ["--course=wren", "--scenario=pt,oa", "--obstacles=2", "--config=default_kinematic", "--methods=mppi", "--set=mppi.samples=32"]


def repeatable(folder):
    """The cells of the table but for clock times, and the bytes of the settings."""
    with (Path(folder) / "laps.csv").open(newline="") as file:
        rows = [[cell for name, cell in row.items() if not CLOCK.fullmatch(name)] for row in csv.DictReader(file)]
    return rows, (Path(folder) / "settings.json").read_bytes()


def dask(what, *words, **environment):
    words = [sys.executable, "-m", f"distributed.cli.dask_{what}", *words, "--no-dashboard"]
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, **environment})


class Cluster:
    """A scheduler and workers of one thread, each a process."""

    def __init__(self, workers=2):
        self.port = random.randrange(10000, 32000)  # none that a connection gets while the scheduler is dead
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.start(workers)

    def start(self, workers=2):
        self.scheduler, self.workers = dask("scheduler", "--host", "127.0.0.1", "--port", str(self.port)), []
        for _ in range(workers):
            self.start_worker()

    def start_worker(self, **environment):
        self.workers.append(dask("worker", self.address, "--no-nanny", "--nthreads", "1", **environment))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in [*self.workers, self.scheduler]:
            end(process)


def end(process):
    process.kill(), process.wait()


def wait_for(out, rows, process):
    """Waits until the journal has so many rows."""
    journal, latest = Path(out) / study.JOURNAL, time.monotonic() + 900
    while process.poll() is None and (not journal.exists() or journal.read_bytes().count(b"\n") <= rows):
        assert time.monotonic() < latest, f"no progress: {journal} has not {rows} rows"
        time.sleep(0.05)


def torn(out, laps):
    """Drives the study and kills worker, scheduler and study on the way; returns how often each was killed while it drove."""
    killed = []
    with Cluster() as cluster:
        words = [study.path_of("slalom"), "eval", *WORLD, f"--laps={laps}", f"--out={out}", f"--cluster={cluster.address}"]
        driver = subprocess.Popen(words, stdout=subprocess.DEVNULL)
        wait_for(out, 2 * laps // 8, driver)
        end(cluster.workers.pop(0))
        killed.append(driver.poll() is None)
        cluster.start_worker()
        wait_for(out, 2 * laps * 3 // 8, driver)
        for process in [cluster.scheduler, *cluster.workers]:  # workers end with their scheduler
            end(process)
        killed.append(driver.poll() is None)
        cluster.start()
        wait_for(out, 2 * laps * 5 // 8, driver)
        killed.append(driver.poll() is None)
        end(driver)
        subprocess.run([*words, "--resume"], check=True, stdout=subprocess.DEVNULL)
    return killed


def check(folder, laps, times):
    subprocess.run([study.path_of("slalom"), "eval", *WORLD, f"--laps={laps}", f"--out={folder}/alone"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for k in range(times):
        killed = torn(f"{folder}/torn{k}", laps)
        assert repeatable(f"{folder}/torn{k}") == repeatable(f"{folder}/alone")
        print(f"{k + 1} of {times}: killed worker, scheduler, study: {killed}; {2 * laps} laps equal", flush=True)
        assert all(killed), "the study had ended before it was killed"


if __name__ == "__main__":
    check(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
