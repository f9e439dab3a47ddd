#!/usr/bin/python3
"""Faults between car and controller. Each must stop the car, with a reason logged at most once per second, and the car
must continue by itself afterwards. Scans, odometry, transforms and map pass through this test, which modifies them.

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
        self.reasons = []
        self.out = {name: rospy.Publisher(f"{name}_test", kind, queue_size=5, latch=name == "map", tcp_nodelay=True)
                    for name, kind in (("scan", LaserScan), ("odom", Odometry), ("tf", TFMessage), ("map", OccupancyGrid))}
        self.out["tf"] = rospy.Publisher("/tf_test", TFMessage, queue_size=20, tcp_nodelay=True)
        rospy.Subscriber("scan", LaserScan, self.scan, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber("odom", Odometry, self.odom, queue_size=5, tcp_nodelay=True)
        rospy.Subscriber("/tf", TFMessage, self.tf, queue_size=20, tcp_nodelay=True)
        rospy.Subscriber("map", OccupancyGrid, self.hear_map, queue_size=1)
        rospy.Subscriber("/rosout", Log, self.hear_log, queue_size=100)

    def hear_log(self, message):
        if message.level >= Log.WARN and message.msg.split(":")[0] in ("stopping", "braking", "localisation"):
            self.reasons.append((time.time(), message.name, message.msg))

    def hear_map(self, message):
        self.map = message
        self.out["map"].publish(message)

    def scan(self, m):
        fault = self.fault
        if fault == "scan silent":
            return
        if fault == "scan of NaN":
            m.ranges = [math.nan] * len(m.ranges)
        if fault == "scan of a wrong count":
            m.ranges = m.ranges[: len(m.ranges) // 2]
        if fault == "scan from the future":
            m.header.stamp += rospy.Duration(5)
        if fault == "scan late":
            m.header.stamp -= rospy.Duration(0.5)
        if fault == "scans out of order":
            if self.held is None:
                self.held = m
                return
            self.out["scan"].publish(m)
            m, self.held = self.held, None
        self.out["scan"].publish(m)

    def jump(self):
        return 3.0 * (int(time.time() / 0.2) % 2) if self.fault == "odometry jumps" else 0

    def odom(self, m):
        fault = self.fault
        if fault == "odometry silent":
            return
        if fault == "odometry of NaN":
            m.twist.twist.linear.x = m.pose.pose.position.x = math.nan
        if fault == "odometry late":
            m.header.stamp -= rospy.Duration(0.5)
        if fault == "odometry from the future":
            m.header.stamp += rospy.Duration(5)
        m.pose.pose.position.x += self.jump()
        self.speed = m.twist.twist.linear.x
        self.out["odom"].publish(m)

    def tf(self, m):
        if self.fault == "tf missing":
            return
        for transform in m.transforms:
            transform.transform.translation.x += self.jump()
            if self.fault == "tf extrapolates":
                transform.header.stamp -= rospy.Duration(1)
            if self.fault == "tf of NaN":
                transform.transform.translation.x = math.nan
        self.out["tf"].publish(m)

    def misfit(self):
        """A map with a wrong resolution."""
        m = copy.deepcopy(self.map)
        m.info.resolution *= 1.6
        self.out["map"].publish(m)

    def said(self, since, word):
        return [r for r in self.reasons if r[0] >= since and word in r[2]]


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

    def go(self):
        while True:
            try:
                self.out.publish(Clock(rospy.Time.from_sec(time.time() + self.ahead)))
            except rospy.ROSException:  # the test is over
                return
            time.sleep(0.004)


FORWARDING = {  # fault of forwarded messages: a word of the reason
    "scan silent": "no scan", "scan of NaN": "", "scan of a wrong count": "number", "scan from the future": "future",
    "scan late": "late", "scans out of order": "out of order", "odometry silent": "no odometry", "odometry of NaN": "finite",
    "odometry late": "late", "odometry from the future": "future", "odometry jumps": "jump", "tf missing": "tf",
    "tf extrapolates": "extrapolation", "tf of NaN": "tf"}


def set_fault(car, fault):
    return lambda: setattr(car, "fault", fault)


def faults(car, clock):
    """Name: function that begins it, function that ends it, a word of the reason."""
    nothing = lambda: None  # noqa: E731
    made = {name: (set_fault(car, name), set_fault(car, None), word) for name, word in FORWARDING.items()}
    made["two planners"] = (lambda: run_planner("planner2"), lambda: kill("planner2"), "another node commands")
    made["a map that does not match"] = (car.misfit, lambda: car.out["map"].publish(car.map), "localisation")
    made["localiser dies"] = (lambda: kill("localiser"), run_localiser, "tf")
    made["world dies"] = (lambda: kill("world"), run_world, "no scan")
    made["clock jumps ahead"] = (lambda: setattr(clock, "ahead", clock.ahead + 20), nothing, "clock")
    made["clock jumps back"] = (lambda: setattr(clock, "ahead", clock.ahead - 20), nothing, "clock")
    return made


def brief_stop(drive, since):
    """A stop that ends by itself: commands of speed 0 for 0.2 s."""
    zeros = [t for t, v, _ in drive.commands if t >= since and v == 0]
    return bool(zeros) and zeros[-1] - zeros[0] > 0.2


def inject(name, fault, car, drive):
    begin_fault, end_fault, word = fault
    wait(f"{name}: drives before", drive.drives, 30)
    time.sleep(0.5)
    begin = time.time()
    begin_fault()
    if name.startswith("clock"):
        wait(f"{name}: stops", lambda: brief_stop(drive, begin), 5)
    else:
        wait(f"{name}: stops", drive.stopped, 5)
        wait(f"{name}: the car stands", lambda: abs(car.speed) < 0.2 or "odom" in name or name == "world dies", 5)
        time.sleep(1.5)
        assert drive.stopped(), f"{name}: does not stay stopped"
    wait(f"{name}: reports the reason ({word})", lambda: car.said(begin, word), 2)
    print("   reason:", car.said(begin, word)[0][1], car.said(begin, word)[0][2][:110], flush=True)
    end_fault()
    wait(f"{name}: drives on", drive.drives, 30)


def planner_death(car, drive):
    """The vehicle stops without commands."""
    wait("planner dies: drives before", drive.drives, 30)
    kill("planner")
    wait("planner dies: the car stands", lambda: abs(car.speed) < 0.2, 3)
    run_planner()
    wait("planner dies: drives on", drive.drives, 30)


def check_reasons(car):
    last, count = {}, 0
    for at, node, text in car.reasons:
        said = last.get(node, 0)
        again = any(name == node and said < begun <= at for begun, name in starts)  # the process was restarted
        assert again or at - said > 0.9, f"{node} logs too often: {text}"
        last[node] = at
        count += 1
    print(f"ok: {count} reasons, none within a second of the one before of the same node", flush=True)


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
    for name, fault in faults(car, clock).items():
        if not chosen or name in chosen:
            inject(name, fault, car, drive)
    if not chosen or "planner dies" in chosen:
        planner_death(car, drive)
    check_reasons(car)


try:
    main()
finally:
    stop_all()
    os.system(f"tail -n 3 {FOLDER}/nodes.log | cut -c1-200")
