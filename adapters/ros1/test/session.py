"""A roscore and nodes for one test, a monitor of the commands, and time limits."""
import os
import signal
import socket
import struct
import subprocess
import sys
import time

PREFIX = os.path.abspath(sys.argv[1])  # where the adapter is installed
NODES = f"{PREFIX}/share/slalom_ros1"


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


PORT = free_port()
os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{PORT}", ROS_IP="127.0.0.1", ROS_PACKAGE_PATH=f"{PREFIX}/share:/usr/share",
                  ROSCONSOLE_FORMAT="[${severity}] [${node}]: ${message}", PYTHONUNBUFFERED="1")
os.environ["PATH"] = "/usr/bin:" + os.environ["PATH"]  # Debian's ROS belongs to Debian's Python

import rospy  # noqa: E402  (reads the environment)

processes = []


def start(*words, log=None):
    out = open(log, "ab") if log else subprocess.DEVNULL
    process = subprocess.Popen(words, stdout=out, stderr=subprocess.STDOUT if log else None)
    processes.append(process)
    return process


def stop_all():
    for process in reversed(processes):
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
    for process in processes:
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()


def start_master():
    start("/usr/bin/roscore", "-p", str(PORT))
    for _ in range(300):
        try:
            rospy.get_master().getPid()
            return
        except OSError:
            time.sleep(0.1)
    raise SystemExit("FAILED: no roscore")


def wait(what, holds, seconds):
    begin = time.time()
    while time.time() < begin + seconds:
        if holds():
            print(f"ok: {what} ({time.time() - begin:.1f} s)", flush=True)
            return
        time.sleep(0.02)
    raise SystemExit(f"FAILED: {what}: not within {seconds} s")


class Drive:
    """The commands on `drive`, each with time and publisher."""

    def __init__(self):
        self.commands = []
        rospy.Subscriber("drive", rospy.AnyMsg, self.hear, queue_size=20)

    def hear(self, message):
        # The last five float32 of an AckermannDriveStamped: steering angle and its rate, speed, acceleration, jerk.
        speed = struct.unpack("<5f", message._buff[-20:])[2]
        self.commands.append((time.time(), speed, message._connection_header["callerid"]))

    def speeds(self, seconds):
        begin = time.time() - seconds
        return [v for t, v, _ in self.commands[-400:] if t >= begin]

    def stopped(self):
        return len(self.speeds(0.3)) > 3 and max(self.speeds(0.3)) == 0

    def drives(self):
        return len(self.speeds(0.3)) > 3 and min(self.speeds(0.3)) > 0.2
