"""Records everything that goes in and comes out of the nodes.

    ros2 launch slalom_ros record.launch.py file:=/tmp/first
"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration

TOPICS = ("scan", "odom", "imu", "drive", "/tf", "/tf_static", "map", "reference_waypoint", "reference_path", "pf/pose/odom",
          "ground_truth", "laps", "contacts", "/diagnostics", "/rosout", "mppi/eval_metrics")


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("file", default_value="slalom", description="the folder that is made"),
        DeclareLaunchArgument("namespace", default_value="", description="of the car's topics, without slashes"),
        ExecuteProcess(cmd=["ros2", "bag", "record", "-o", LaunchConfiguration("file"), *(
            topic if topic.startswith("/") else ["/", LaunchConfiguration("namespace"), "/", topic] for topic in TOPICS)],
            output="screen")])
