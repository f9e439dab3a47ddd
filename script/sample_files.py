"""Files that script/damage changes: bags of ROS 1, and maps as PGM."""

import json
import math
import struct
import zlib


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


def pgm_of(png):
    """A map image, 8 bits of grey without interlacing, as a binary PGM."""
    data = png.read_bytes()
    at, packed, head = 8, b"", b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        head = body if kind == b"IHDR" else head
        packed += body if kind == b"IDAT" else b""
        at += 12 + size
    width, height, depth, colour, _, _, interlaced = struct.unpack(">IIBBBBB", head)
    if (depth, colour, interlaced) != (8, 0, 0):
        raise ValueError(f"{png}: must have 8 bits of grey without interlacing")
    rows, before, raw = b"", bytes(width), zlib.decompress(packed)
    for row in range(height):
        method, line = raw[row * (width + 1)], bytearray(raw[row * (width + 1) + 1:(row + 1) * (width + 1)])
        for i in range(width):
            left, up, corner = (line[i - 1], before[i], before[i - 1]) if i else (0, before[i], 0)
            nearest = min((left, up, corner), key=lambda value, sum=left + up - corner: abs(sum - value))
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        before = bytes(line)
        rows += before
    return b"P5\n%d %d\n255\n" % (width, height) + rows
