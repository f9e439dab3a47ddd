"""The faults of faults.csv, and what must hold while the nodes of a car have one."""
import csv
import os
import time
from collections import namedtuple

Fault = namedtuple("Fault", "name of change value reason")


def read_faults():
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "faults.csv")) as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [Fault(r["name"], r["of"], r["change"], float(r["value"] or 0), r["reason"]) for r in rows]


def wait(what, holds, seconds):
    begin = time.time()
    while time.time() < begin + seconds:
        if holds():
            print(f"ok: {what} ({time.time() - begin:.1f} s)", flush=True)
            return
        time.sleep(0.02)
    raise SystemExit(f"FAILED: {what}: not within {seconds} s")


class Commands:
    """The speeds that a car is commanded to drive with, each with its time."""

    def __init__(self):
        self.heard = []

    def add(self, speed):
        self.heard.append((time.time(), speed))

    def speeds(self, seconds):
        begin = time.time() - seconds
        return [v for t, v in self.heard[-400:] if t >= begin]

    def stopped(self):
        speeds = self.speeds(0.3)
        return len(speeds) > 3 and max(speeds) == 0

    def drives(self):
        speeds = self.speeds(0.3)
        return len(speeds) > 3 and min(speeds) > 0.2

    def stopped_briefly(self, since):
        """A stop that ends by itself: commands of speed 0 for 0.15 s."""
        zeros = [t for t, v in self.heard if t >= since and v == 0]
        return bool(zeros) and zeros[-1] - zeros[0] > 0.15


class Reasons:
    """What the nodes log of why the car stops."""

    def __init__(self):
        self.heard = []  # (time, node, text)

    def add(self, node, text):
        if text.split(":")[0] in ("stopping", "braking", "localisation"):
            self.heard.append((time.time(), node, text))

    def said(self, since, words):
        return [(node, text) for at, node, text in self.heard if at >= since and words in text]

    def check(self, starts):
        """No node logs more than once per second. `starts` has the times and nodes of all starts of processes."""
        last = {}
        for at, node, text in self.heard:
            before = last.get(node, 0)
            again = any(name == node and before < begun <= at for begun, name in starts)
            assert again or at - before > 0.9, f"{node} logs too often: {text}"
            last[node] = at
        print(f"ok: {len(self.heard)} reasons, none within a second of the one before of the same node", flush=True)


def inject(fault, begin_fault, end_fault, commands, reasons, stands):
    """Begins a fault while the car drives: it stops, stays stopped, and drives on afterwards. `stands` tells whether the
    car stands, as far as that is known."""
    name = fault.name
    wait(f"{name}: drives before", commands.drives, 30)
    time.sleep(0.5)
    begin = time.time()
    begin_fault()
    if fault.of == "clock":  # it jumps once; the car continues by itself
        wait(f"{name}: stops", lambda: commands.stopped_briefly(begin), 5)
    else:
        wait(f"{name}: stops", commands.stopped, 5)
        wait(f"{name}: the car stands", stands, 5)
        time.sleep(1.5)
        assert commands.stopped(), f"{name}: does not stay stopped"
    wait(f"{name}: reports the reason ({fault.reason})", lambda: reasons.said(begin, fault.reason), 2)
    node, text = reasons.said(begin, fault.reason)[0]
    print("   reason:", node, text[:110], flush=True)
    end_fault()
    wait(f"{name}: drives on", commands.drives, 30)
