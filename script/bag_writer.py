"""Writes bags of ROS 1 for script/damage."""

import json
import math
import struct


def record(fields, data):
    """A record of a bag of ROS 1."""
    header = b"".join(struct.pack("<I", len(key) + 1 + len(value)) + key + b"=" + value for key, value in fields.items())
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag_of(lines):
    """A bag with the poses, speeds, scans and commands of a recording in JSON lines."""
    def header(stamp, frame):
        return struct.pack("<III", 0, int(stamp), round(1e9 * (stamp % 1)) % 10**9) + text(frame)

    def text(word):
        return struct.pack("<I", len(word)) + word

    def odometry(stamp, x, y, yaw, speed):
        return (header(stamp, b"map") + text(b"base") +
                struct.pack("<7d", x, y, 0, 0, 0, math.sin(yaw / 2), math.cos(yaw / 2)) + bytes(36 * 8) +
                struct.pack("<6d", speed, 0, 0, 0, 0, 0) + bytes(36 * 8))

    topics = {b"/odom": b"nav_msgs/Odometry", b"/pf/pose/odom": b"nav_msgs/Odometry",
              b"/scan": b"sensor_msgs/LaserScan", b"/drive": b"ackermann_msgs/AckermannDriveStamped"}
    records = b""
    for number, (topic, kind) in enumerate(topics.items()):
        said = b"".join(text(each) for each in (b"topic=" + topic, b"type=" + kind))
        records += record({b"op": b"\x07", b"conn": struct.pack("<I", number), b"topic": topic}, said)
    for line in lines.read_text().splitlines():
        tick = json.loads(line)
        if tick["type"] != "tick":
            continue
        stamp = 10 + tick["time"]
        x, y, yaw, speed = tick["odometry"]
        angle_min, increment, nearest, farthest = tick["scan"]
        steer, commanded = tick["command"]
        scan = struct.pack("<7fI2fI", angle_min, -angle_min, increment, 0, 0, nearest, farthest, 2, 1.5, 2, 0)
        messages = (odometry(stamp - 0.01, 0, 0, 0, speed), odometry(stamp, x, y, yaw, speed),
                    header(stamp, b"laser") + scan,
                    header(stamp + 0.01, b"") + struct.pack("<2f2f2f", steer, 0, commanded, 0, 0, 0)[:20])
        for number, message in enumerate(messages):
            records += record({b"op": b"\x02", b"conn": struct.pack("<I", number), b"time": bytes(8)}, message)
    chunk = {b"op": b"\x05", b"compression": b"none", b"size": struct.pack("<I", len(records))}
    return b"#ROSBAG V2.0\n" + record({b"op": b"\x03", b"index_pos": bytes(8)}, b" " * 100) + record(chunk, records)
