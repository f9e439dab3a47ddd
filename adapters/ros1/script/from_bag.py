#!/usr/bin/python3
"""Makes a recording, as `slalom identify` reads it, from a bag: for every scan the pose that the driver was told, the
measured speed, and the command it sent.

usage: from_bag.py FILE.bag RECORDING.jsonl
"""
import bisect
import json
import math
import sys

import rosbag


def yaw_of(q):
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def number(value):
    return value if math.isfinite(value) else None


def read(file):
    """Per topic, (stamp, message), by stamp."""
    topics = {"/scan": [], "/odom": [], "/drive": [], "/pf/pose/odom": []}
    with rosbag.Bag(file) as bag:
        for topic, message, _ in bag.read_messages(topics=list(topics)):
            topics[topic].append((message.header.stamp.to_sec(), message))
    for messages in topics.values():
        messages.sort(key=lambda m: m[0])
    return topics





def ticks(topics):
    """One for every command: the pose is that of the last scan before it, carried on by nothing; the time is the scan's."""
    poses, odometry, scans = topics["/pf/pose/odom"], topics["/odom"], dict(topics["/scan"])
    pose_stamps = [m[0] for m in poses]
    odometry_stamps = [m[0] for m in odometry]
    step = 0
    for stamp, drive in topics["/drive"]:
        i = bisect.bisect_right(pose_stamps, stamp) - 1
        j = bisect.bisect_right(odometry_stamps, stamp) - 1
        if i < 0 or j < 0 or stamp - pose_stamps[i] > 0.2:
            continue
        pose, speed = poses[i][1].pose.pose, odometry[j][1].twist.twist.linear.x
        scan = scans.get(pose_stamps[i])
        tick = {"type": "tick", "step": step, "time": pose_stamps[i],
                "odometry": [number(v) for v in (pose.position.x, pose.position.y, yaw_of(pose.orientation), speed)]}
        if scan is not None:
            tick["scan"] = [scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max]
            tick["ranges"] = [number(r) for r in scan.ranges]
        tick["command"] = [number(drive.drive.steering_angle), number(drive.drive.speed)]
        yield tick
        step += 1


def main():
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    topics = read(sys.argv[1])
    for topic, messages in topics.items():
        if not messages:
            raise SystemExit(f"from_bag.py: {sys.argv[1]}: nothing on {topic}")
    begin = topics["/scan"][0][0]
    count = 0
    with open(sys.argv[2], "w") as out:
        out.write(json.dumps({"type": "recording", "version": 1, "program": "from_bag", "settings": {"bag": sys.argv[1]}}) + "\n")
        for tick in ticks(topics):
            tick["time"] -= begin
            out.write(json.dumps(tick, separators=(",", ":")) + "\n")
            count += 1
    print(f"{count} ticks")


main()
