#!/usr/bin/python3
"""The faults of adapters/test/faults.csv that the ROS 2 node can have, over the wire: each must stop the car, with a reason
logged at most once per second, and the car must continue by itself afterwards. The car is on another implementation of
the protocol, Fast DDS.

usage: fault_test.py PREFIX_OF_INSTALL BUILD_FOLDER [FAULT...]
"""
import os
import random
import signal
import subprocess
import sys
import threading
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "test"))

from faults import Commands, Reasons, inject, read_faults, wait  # noqa: E402

PREFIX, BUILD = (os.path.abspath(folder) for folder in sys.argv[1:3])
DOMAIN = str(random.randint(1, 100))
COURSE, OBSTACLES = "wren", "3"
LOG = open(f"{BUILD}/faults.log", "w")
processes = []
starts = []  # (time, name) of every driver's process


def start(*words, **streams):
    process = subprocess.Popen(words, text=True, bufsize=1, **streams)
    processes.append(process)
    return process


def follow(stream, use):
    """Calls `use` with every line of a stream."""
    def read():
        for line in stream:
            use(line.rstrip("\n"))
    threading.Thread(target=read, daemon=True).start()


class Car:
    """The car on Fast DDS: what it is commanded, and how fast it drives."""

    def __init__(self):
        self.commands = Commands()
        self.speed = 0
        os.environ["SLALOM_COURSES_DIR"] = f"{PREFIX}/share/slalom/courses"
        self.process = start(f"{BUILD}/slalom_ros2_fault_peer", COURSE, OBSTACLES, DOMAIN,
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        follow(self.process.stdout, self.hear)

    def hear(self, line):
        word, _, value = line.partition(" ")
        if word == "command":
            self.commands.add(float(value))
        if word == "speed":
            self.speed = float(value)

    def tell(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def begin(self, fault):
        self.tell(",".join((fault.name, fault.of, fault.change, repr(fault.value), fault.reason)))

    def end(self):
        self.tell("end")

    def stands(self):
        return abs(self.speed) < 0.2


def start_driver(name, reasons):
    starts.append((time.time(), name))
    driver = start(f"{PREFIX}/bin/slalom_ros2_driver", "--course", COURSE, "--domain", DOMAIN, "--map-from-topic", "--sim-time",
                   stderr=subprocess.PIPE)

    def hear(line):
        print(f"{name}: {line}", file=LOG, flush=True)
        reasons.add(name, line)

    follow(driver.stderr, hear)
    return driver


def kill(process):
    process.send_signal(signal.SIGKILL)
    process.wait()


def run_fault(fault, car, reasons):
    second = []
    begin, end = lambda: car.begin(fault), car.end
    if fault.change == "twice":
        begin, end = lambda: second.append(start_driver("second driver", reasons)), lambda: kill(second[0])
    inject(fault, begin, end, car.commands, reasons, car.stands)


def main():
    car, reasons = Car(), Reasons()
    print("log:", LOG.name, flush=True)
    driver = start_driver("driver", reasons)
    chosen = sys.argv[3:]
    for fault in read_faults():
        if fault.of in ("tf", "localiser") or chosen and fault.name not in chosen:
            continue
        if fault.name == "planner dies":  # the last one; the car stops without commands
            wait(f"{fault.name}: drives before", car.commands.drives, 30)
            kill(driver)
            wait(f"{fault.name}: the car stands", car.stands, 3)
        else:
            run_fault(fault, car, reasons)
    reasons.check(starts)


try:
    main()
finally:
    for each in processes:
        each.kill()
    os.system(f"tail -n 3 {BUILD}/faults.log | cut -c1-200")
