#!/usr/bin/python3
"""The faults of adapters/test/faults.csv between car and controller. Each must stop the car, with a reason logged at most
once per second, and the car must continue by itself afterwards. Scans, odometry, transforms and map pass through this
test, which modifies them.

usage: fault_test.py PREFIX_OF_INSTALL [FAULT...]
"""
import copy
import math
import os
import signal
import sys
import tempfile
import threading
import time

from session import Drive, NODES, start, start_master, stop_all, wait, rospy  # noqa: I001

from faults import Reasons, inject, read_faults
from nav_msgs.msg import OccupancyGrid, Odometry
from rosgraph_msgs.msg import Clock, Log
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

FOLDER = tempfile.mkdtemp(prefix="slalom_faults_")
OBSTACLES = 3
nodes = {}
starts = []  # (time, name) of every node's process


class Car:
    """Forwards the messages of the world, modified according to `fault`."""

    def __init__(self):
        self.fault = None
        self.held = None
        self.map = None
        self.speed = 0
        self.reasons = Reasons()
        self.out = {name: rospy.Publisher(f"{name}_test", kind, queue_size=5, latch=name == "map", tcp_nodelay=True)
                    for name, kind in (("scan", LaserScan), ("odom", Odometry), ("tf", TFMessage), ("map", OccupancyGrid))}
        self.out["tf"] = rospy.Publisher("/tf_test", TFMessage, queue_size=20, tcp_nodelay=True)
        rospy.Subscriber("scan", LaserScan, self.scan, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber("odom", Odometry, self.odom, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber("/tf", TFMessage, self.tf, queue_size=20, tcp_nodelay=True)
        rospy.Subscriber("map", OccupancyGrid, self.hear_map, queue_size=1)
        rospy.Subscriber("/rosout", Log, self.hear_log, queue_size=100)

    def hear_log(self, message):
        if message.level >= Log.WARN:
            self.reasons.add(message.name, message.msg)

    def hear_map(self, message):
        self.map = message
        self.out["map"].publish(message)

    def change_of(self, stream):
        """How the messages of a stream are changed now, and by which value."""
        fault = self.fault
        return (fault.change, fault.value) if fault and fault.of == stream else (None, 0)

    def scan(self, m):
        change, value = self.change_of("scan")
        if change == "silent":
            return
        if change == "not a number":
            m.ranges = [math.nan] * len(m.ranges)
        if change == "half of the beams":
            m.ranges = m.ranges[: len(m.ranges) // 2]
        if change == "stamp":
            m.header.stamp += rospy.Duration.from_sec(value)
        if change == "swapped":
            if self.held is None:
                self.held = m
                return
            self.out["scan"].publish(m)
            m, self.held = self.held, None
        self.out["scan"].publish(m)

    def jump(self):
        change, value = self.change_of("odometry")
        return value * (int(time.time() / 0.2) % 2) if change == "jumps" else 0

    def odom(self, m):
        change, value = self.change_of("odometry")
        if change == "silent":
            return
        if change == "not a number":
            m.twist.twist.linear.x = m.pose.pose.position.x = math.nan
        if change == "stamp":
            m.header.stamp += rospy.Duration.from_sec(value)
        if change == "shift":
            m.pose.pose.position.x += value
        if change == "speed":
            m.twist.twist.linear.x = value
        m.pose.pose.position.x += self.jump()
        self.speed = m.twist.twist.linear.x
        self.out["odom"].publish(m)

    def tf(self, m):
        change, value = self.change_of("tf")
        if change == "silent":
            return
        for transform in m.transforms:
            transform.transform.translation.x += self.jump()
            if change == "stamp":
                transform.header.stamp += rospy.Duration.from_sec(value)
            if change == "not a number":
                transform.transform.translation.x = math.nan
        self.out["tf"].publish(m)

    def misfit(self, value):
        """A map whose resolution is wrong by a factor."""
        m = copy.deepcopy(self.map)
        m.info.resolution *= value
        self.out["map"].publish(m)

    def stands(self):
        """Whether the car stands, where the messages tell its speed."""
        hidden = self.fault is not None and self.fault.of in ("odometry", "world")
        return hidden or abs(self.speed) < 0.2


def run(name, *arguments):
    starts.append((time.time(), f"/{name}"))
    nodes[name] = start(f"{NODES}/{name.rstrip('2')}_node", f"__name:={name}", *arguments, log=f"{FOLDER}/nodes.log")


TEST_TOPICS = ("scan:=scan_test", "odom:=odom_test", "/tf:=/tf_test")


def run_world():
    run("world", f"_obstacles:={OBSTACLES}", "_course:=wren")


def run_localiser():
    run("localiser", "map:=map_test", *TEST_TOPICS)


def run_planner(name="planner"):
    run(name, *TEST_TOPICS)


def kill(name):
    nodes[name].send_signal(signal.SIGKILL)
    nodes[name].wait()


class Clocks:
    """The clock of all nodes: the system clock with jumps."""

    def __init__(self):
        self.ahead = 0.0
        self.out = rospy.Publisher("/clock", Clock, queue_size=1, tcp_nodelay=True)
        threading.Thread(target=self.go, daemon=True).start()

    def jump(self, seconds):
        self.ahead += seconds

    def go(self):
        while True:
            try:
                self.out.publish(Clock(rospy.Time.from_sec(time.time() + self.ahead)))
            except rospy.ROSException:  # the test is over
                return
            time.sleep(0.004)


def begin_and_end(fault, car, clock):
    """The functions that begin and end a fault."""
    nothing = lambda: None  # noqa: E731
    if fault.of == "map":
        return lambda: car.misfit(fault.value), lambda: car.out["map"].publish(car.map)
    if fault.of == "clock":
        return lambda: clock.jump(fault.value), nothing
    if fault.change == "twice":
        return lambda: run_planner("planner2"), lambda: kill("planner2")
    if fault.change == "dies":
        return lambda: kill(fault.of), {"localiser": run_localiser, "world": run_world}[fault.of]
    return nothing, nothing  # a change of messages


def run_fault(fault, car, clock, drive):
    begin, end = begin_and_end(fault, car, clock)

    def begin_fault():
        car.fault, car.held = fault, None
        begin()

    def end_fault():
        car.fault = None
        end()

    inject(fault, begin_fault, end_fault, drive, car.reasons, car.stands)


def planner_death(car, drive):
    """The vehicle stops without commands."""
    wait("planner dies: drives before", drive.drives, 30)
    kill("planner")
    wait("planner dies: the car stands", car.stands, 3)
    run_planner()
    wait("planner dies: drives on", drive.drives, 30)


def main():
    start_master()
    rospy.set_param("/use_sim_time", True)
    rospy.init_node("fault_test", disable_signals=True)
    clock, car, drive = Clocks(), Car(), Drive()
    print("log:", f"{FOLDER}/nodes.log", flush=True)
    run_world()
    run_localiser()
    run_planner()
    chosen = sys.argv[2:]
    for fault in read_faults():
        if chosen and fault.name not in chosen:
            continue
        if fault.name == "planner dies":
            planner_death(car, drive)
        else:
            run_fault(fault, car, clock, drive)
    car.reasons.check(starts)


try:
    main()
finally:
    stop_all()
    os.system(f"tail -n 3 {FOLDER}/nodes.log | cut -c1-200")
