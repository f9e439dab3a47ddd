"""Records all topics of the nodes.

    ros2 launch slalom_ros record.launch.py file:=/tmp/first
"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction

TOPICS = ("scan", "odom", "imu", "drive", "/tf", "/tf_static", "map", "reference_waypoint", "reference_path", "pf/pose/odom",
          "ground_truth", "laps", "contacts", "/diagnostics", "/rosout", "mppi/eval_metrics")


def record(context):
    namespace = context.launch_configurations["namespace"].strip("/")
    prefix = f"/{namespace}/" if namespace else "/"
    topics = [topic if topic.startswith("/") else prefix + topic for topic in TOPICS]
    return [ExecuteProcess(cmd=["ros2", "bag", "record", "-o", context.launch_configurations["file"], *topics],
                           output="screen")]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("file", default_value="slalom", description="the folder that is made"),
        DeclareLaunchArgument("namespace", default_value="", description="of the car's topics"),
        OpaqueFunction(function=record)])
