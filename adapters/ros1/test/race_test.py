#!/usr/bin/python3
"""Laps among parked cars through ROS alone, started from the launch files and recorded in a bag that is read back.

usage: race_test.py PREFIX_OF_INSTALL [LAPS [OBSTACLES [COURSE]]]
"""
import collections
import os
import subprocess
import sys
import tempfile
import time

from session import Drive, NODES, PORT, PREFIX, processes, start, stop_all, wait, rospy  # noqa: I001

import dynamic_reconfigure.client
import rosbag
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from std_msgs.msg import Int32
from visualization_msgs.msg import MarkerArray

LAPS = int(sys.argv[2]) if len(sys.argv) > 2 else 3
OBSTACLES = int(sys.argv[3]) if len(sys.argv) > 3 else 5
COURSE = sys.argv[4] if len(sys.argv) > 4 else "wren"
DRIVE_MD5 = "1fd5d7f58889cefd44d29f6653240d0c"  # of ackermann_msgs/AckermannDriveStamped as it is published


class Seen:
    def __init__(self):
        self.laps = self.contacts = 0
        self.last, self.statuses = {}, {}
        self.speed = 0
        for topic, kind in (("map", OccupancyGrid), ("obstacles", MarkerArray), ("planner_markers", MarkerArray),
                            ("reference_path", Path), ("pf/pose/odom", Odometry)):
            rospy.Subscriber(topic, kind, lambda m, topic=topic: self.last.__setitem__(topic, m), queue_size=1)
        rospy.Subscriber("laps", Int32, lambda m: setattr(self, "laps", m.data), queue_size=1)
        rospy.Subscriber("contacts", Int32, lambda m: setattr(self, "contacts", m.data), queue_size=1)
        rospy.Subscriber("odom", Odometry, lambda m: setattr(self, "speed", m.twist.twist.linear.x), queue_size=1)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self.hear, queue_size=5)

    def hear(self, message):
        for status in message.status:
            self.statuses[status.name] = {v.key: v.value for v in status.values}


def check_parameters(seen, drive):
    """Changes an option while the car drives, and checks that an invalid value is rejected."""
    client = dynamic_reconfigure.client.Client("planner", timeout=10)
    first = client.get_configuration()["planner/max_speed"]
    client.update_configuration({"planner/max_speed": 1.0})
    wait("max_speed changed while driving", lambda: max(drive.speeds(0.3), default=9) <= 1.0 and seen.speed < 1.3, 5)
    answer = client.update_configuration({"svg_mppi/samples": -3})
    assert answer["svg_mppi/samples"] > 0, "a value out of range was accepted"
    client.update_configuration({"planner/max_speed": first})
    print("ok: a value out of range is rejected; options:", len(client.get_configuration()), flush=True)


def read_back(file):
    counts, speeds = collections.Counter(), []
    with rosbag.Bag(file) as bag:
        topics = bag.get_type_and_topic_info()[1]
        assert topics["/drive"].msg_type == "ackermann_msgs/AckermannDriveStamped"
        assert {c.md5sum for c in bag._get_connections() if c.topic == "/drive"} == {DRIVE_MD5}
        begin, end = bag.get_start_time(), bag.get_end_time()
        laps = 0
        for topic, message, _ in bag.read_messages():
            counts[topic] += 1
            if topic == "/drive":
                speeds.append(message.drive.speed)
            if topic == "/laps":
                laps = max(laps, message.data)
    for topic in ("/scan", "/odom", "/drive", "/tf", "/tf_static", "/map", "/pf/pose/odom", "/diagnostics"):
        assert counts[topic] > 0, f"{topic} is not in the bag"
    assert counts["/scan"] > 35 * (end - begin - 2), counts
    assert laps >= LAPS, laps
    print(f"ok: bag of {end - begin:.1f} s read back: {counts['/scan']} scans, {counts['/drive']} commands, "
          f"mean speed {sum(speeds) / len(speeds):.2f} m/s, {laps} laps", flush=True)


def show(file):
    """Runs the program on the bag, if it is installed."""
    program = f"{PREFIX}/bin/slalom"
    if not os.path.exists(program):
        return print("skipped: slalom replay and identify: the program is not installed", flush=True)
    for words in (("replay", file, "--record", file + ".mcap"), ("replay", file, "--record", file + ".jsonl"),
                  ("identify", file, "--wheelbase", "0.3302")):
        done = subprocess.run([program, *words], capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        print("ok: slalom", words[0], *done.stdout.strip().splitlines(), sep="\n   ", flush=True)


def main():
    folder = tempfile.mkdtemp(prefix="slalom_race_")
    start("/usr/bin/roslaunch", "-p", str(PORT), "slalom_ros1", "race.launch", f"course:={COURSE}", f"obstacles:={OBSTACLES}",
          log=f"{folder}/launch.log")
    for _ in range(300):
        try:
            rospy.get_master().getPid()
            break
        except OSError:
            time.sleep(0.1)
    rospy.init_node("race_test", disable_signals=True)
    seen, drive = Seen(), Drive()
    recorder = start("/usr/bin/roslaunch", "-p", str(PORT), "slalom_ros1", "record.launch", f"file:={folder}/race",
                     log=f"{folder}/launch.log")
    print("log:", f"{folder}/launch.log", flush=True)
    wait("the car drives", lambda: max(drive.speeds(1), default=0) > 0.5, 60)
    check_parameters(seen, drive)
    begin, done = time.time(), seen.laps
    wait(f"{LAPS} laps among {OBSTACLES} obstacles on {COURSE}", lambda: seen.laps >= done + LAPS, 60 * LAPS)
    print(f"lap time {(time.time() - begin) / LAPS:.1f} s, contacts: {seen.contacts}", flush=True)
    assert seen.contacts == 0
    for topic in ("map", "obstacles", "planner_markers", "reference_path", "pf/pose/odom"):
        assert topic in seen.last, f"nothing on {topic}"
    assert len(seen.last["obstacles"].markers) == OBSTACLES + 1
    for name, key in (("planner: plans", "deadlines missed"), ("planner: plans", "least effective sample size"),
                      ("localiser: localisation", "health")):
        assert key in seen.statuses[name], (name, seen.statuses)
    print("ok: map, markers, path, pose and diagnostics are there:", seen.statuses, flush=True)
    recorder.send_signal(2)
    recorder.wait(20)
    bags = [f for f in os.listdir(folder) if f.endswith(".bag")]
    assert len(bags) == 1, bags
    read_back(f"{folder}/{bags[0]}")
    show(f"{folder}/{bags[0]}")


try:
    main()
finally:
    stop_all()
