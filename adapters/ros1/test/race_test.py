#!/usr/bin/python3
"""Starts a roscore and the three nodes, drives laps among parked cars and injects faults on the way of the scans.

usage: race_test.py FOLDER_OF_NODES [LAPS [OBSTACLES]]
"""
import math
import os
import socket
import subprocess
import sys
import time


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


NODES, LAPS = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 3
OBSTACLES = int(sys.argv[3]) if len(sys.argv) > 3 else 5
os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{free_port()}"
os.environ["ROS_IP"] = "127.0.0.1"

import rospy  # noqa: E402  (reads the environment)
from sensor_msgs.msg import LaserScan  # noqa: E402
from std_msgs.msg import Int32  # noqa: E402

processes = []


def start(*words):
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    processes.append(process)
    return process


def wait(what, holds, seconds):
    end = time.time() + seconds
    while time.time() < end:
        if holds():
            print("ok:", what, flush=True)
            return
        time.sleep(0.05)
    raise SystemExit(f"FAILED: {what}: not within {seconds} s")


class Car:
    """Hears drive, laps and contacts; passes scans on, with a fault if one is set."""

    def __init__(self):
        self.fault = None
        self.commands = []
        self.laps = self.contacts = 0
        self.out = rospy.Publisher("scan_test", LaserScan, queue_size=1)
        rospy.Subscriber("scan", LaserScan, self.pass_on, queue_size=1)
        rospy.Subscriber("laps", Int32, lambda m: setattr(self, "laps", m.data), queue_size=1)
        rospy.Subscriber("contacts", Int32, lambda m: setattr(self, "contacts", m.data), queue_size=1)
        rospy.Subscriber("drive", rospy.AnyMsg, self.hear_drive, queue_size=5)

    def hear_drive(self, message):
        import struct
        # The last five float32 of an AckermannDriveStamped: steering angle and its rate, speed, acceleration, jerk.
        self.commands.append((time.time(), struct.unpack("<5f", message._buff[-20:])[2]))

    def pass_on(self, scan):
        if self.fault == "silence":
            return
        if self.fault == "nan":
            scan.ranges = [math.nan] * len(scan.ranges)
        if self.fault == "count":
            scan.ranges = scan.ranges[: len(scan.ranges) // 2]
        if self.fault == "future":
            scan.header.stamp += rospy.Duration(5)
        if self.fault == "old":
            scan.header.stamp -= rospy.Duration(0.5)
        self.out.publish(scan)

    def speeds(self, seconds):
        begin = time.time() - seconds
        return [v for t, v in list(self.commands) if t >= begin]


def main():
    start("/usr/bin/roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1])
    for _ in range(200):
        try:
            rospy.get_master().getPid()
            break
        except OSError:
            time.sleep(0.1)
    rospy.init_node("race_test", disable_signals=True)
    car = Car()
    start(f"{NODES}/world_node", f"_obstacles:={OBSTACLES}", "_course:=wren")
    start(f"{NODES}/localiser_node", "_course:=wren", "scan:=scan_test")
    start(f"{NODES}/planner_node", "_course:=wren", "scan:=scan_test")

    wait("the car drives", lambda: max(car.speeds(1), default=0) > 0.5, 60)
    for fault in ("silence", "nan", "count", "future", "old"):
        time.sleep(1)
        car.fault = fault
        wait(f"{fault}: stops", lambda: len(car.speeds(0.3)) > 3 and max(car.speeds(0.3)) == 0, 3)
        car.fault = None
        wait(f"{fault}: drives on", lambda: max(car.speeds(0.3), default=0) > 0.3, 10)
    wait(f"{LAPS} laps", lambda: car.laps >= LAPS, 90 * LAPS)
    print("contacts:", car.contacts, flush=True)


try:
    main()
finally:
    for process in reversed(processes):
        process.terminate()
    for process in processes:
        process.wait(10)
