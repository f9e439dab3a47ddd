"""A roscore and nodes for one test, a monitor of the commands, and time limits."""
import os
import signal
import socket
import struct
import subprocess
import sys
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "test"))

from faults import Commands, wait  # noqa: E402, F401  (wait is for the tests)

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


class Drive(Commands):
    """The commands on `drive`."""

    def __init__(self):
        super().__init__()
        rospy.Subscriber("drive", rospy.AnyMsg, self.hear, queue_size=20)

    def hear(self, message):
        # The last five float32 of an AckermannDriveStamped: steering angle and its rate, speed, acceleration, jerk.
        self.add(struct.unpack("<5f", message._buff[-20:])[2])
