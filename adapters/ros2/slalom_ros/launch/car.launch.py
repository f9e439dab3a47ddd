"""Localisation and planner for a car that publishes scan, odom and tf and listens to drive.

With a course, map and path are read from it; without, they come from the topics map and reference_waypoint. The car
drives at most 1 m/s unless max_speed says otherwise. `ros2 launch slalom_ros car.launch.py --show-args` lists all
arguments.
"""
import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch_ros.actions import LoadComposableNodes, Node
from launch_ros.descriptions import ComposableNode

ARGUMENTS = (
    ("course", "", "a name or a folder; empty: map and path are topics"),
    ("configuration", "default", "a name or a file"),
    ("method", "svg_mppi", "the solver"),
    ("max_speed", "1.0", "m/s"),
    ("params", "", "a YAML file with parameters of the nodes planner and localiser"),
    ("localise", "true", "false: something else publishes the transform from the map to the car"),
    ("everywhere", "false", "the localiser searches the whole map at the start"),
    ("pose_file", os.path.join(os.path.expanduser("~"), ".ros", "slalom_pose"),
     "from which a localiser that is restarted continues"),
    ("namespace", "", "of the nodes"),
    ("scan", "scan", "topic"),
    ("odom", "odom", "topic"),
    ("imu", "imu", "topic"),
    ("drive", "drive", "topic"),
    ("map_frame", "map", ""),
    ("base_frame", "base_link", "x ahead, y to the left"),
    ("rear_axle", "0.0", "m, x of the middle of the rear axle in the base frame"),
    ("scan_interval", "0.0", "s, scans that come sooner after the last one used are not used"),
    ("view_port", "0", "of a page that shows the plans; 0: none"),
    ("use_sim_time", "false", "the time is that of the topic clock"),
    ("container", "", "a component container that loads the nodes; empty: each is a process"),
)


def nodes(context):
    given = {name: context.launch_configurations[name] for name, _, _ in ARGUMENTS}
    common = {
        "autostart": True,
        "course": given["course"],
        "map_frame": given["map_frame"],
        "base_frame": given["base_frame"],
        "rear_axle": float(given["rear_axle"]),
        "use_sim_time": given["use_sim_time"] == "true",
    }
    planner = {
        "configuration": given["configuration"],
        "method": given["method"],
        "planner.max_speed": float(given["max_speed"]),
        "scan_interval": float(given["scan_interval"]),
        "view_port": int(given["view_port"]),
    }
    localiser = {"everywhere": given["everywhere"] == "true", "pose_file": given["pose_file"]}
    file = [given["params"]] if given["params"] else []
    remappings = [(topic, given[topic]) for topic in ("scan", "odom", "imu", "drive") if given[topic] != topic]
    wanted = [("planner", "PlannerNode", planner)]
    if given["localise"] == "true":
        os.makedirs(os.path.dirname(given["pose_file"]) or ".", exist_ok=True)
        wanted.append(("localiser", "LocaliserNode", localiser))
    if given["container"]:
        return [LoadComposableNodes(target_container=given["container"], composable_node_descriptions=[
            ComposableNode(package="slalom_ros", plugin=f"slalom_ros::{plugin}", name=name,
                           namespace=given["namespace"], parameters=[{**common, **own}, *file], remappings=remappings)
            for name, plugin, own in wanted])]
    return [Node(package="slalom_ros", executable=f"{name}_node", name=name, namespace=given["namespace"],
                 parameters=[{**common, **own}, *file], remappings=remappings, respawn=True, respawn_delay=0.5,
                 output="screen")
            for name, _, own in wanted]


def generate_launch_description():
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=text) for name, default, text in ARGUMENTS),
        OpaqueFunction(function=nodes)])
