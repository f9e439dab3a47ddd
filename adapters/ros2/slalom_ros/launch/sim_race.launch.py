"""A car in a simulator, with localisation and planner.

    ros2 launch slalom_ros sim_race.launch.py course:=wren obstacles:=5 rviz:=true
    ros2 launch slalom_ros sim_race.launch.py composed:=true
    ros2 launch slalom_ros sim_race.launch.py simulator:=f1tenth_gym course:=/path/to/course cars:=2

The simulator is Slalom's, or the node of f1tenth_gym_ros. That one publishes the true pose as transform from the map to
the car, so no localiser runs. Its file config/sim.yaml names its map, which must be that of the course, and num_agent,
which must be the number of cars.
"""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode

ARGUMENTS = (
    ("course", "wren", "a name or a folder"),
    ("obstacles", "5", "number of parked cars of Slalom's simulator"),
    ("seed", "1", "of noise and parked cars of Slalom's simulator"),
    ("configuration", "default", "a name or a file"),
    ("method", "svg_mppi", "the solver"),
    ("max_speed", "100.0", "m/s; the speeds of the course are not exceeded either"),
    ("composed", "false", "all nodes in one process"),
    ("rviz", "false", ""),
    ("simulator", "slalom", "or f1tenth_gym"),
    ("start_gym", "true", "f1tenth_gym: launch the simulator, too"),
    ("cars", "1", "f1tenth_gym: 1 or 2, each with its planner"),
)

# As in f1tenth_gym_ros, the frame base_link moves with the centre of gravity, 0.17145 m ahead of the rear
# axle, and the scans come at 250 Hz.
GYM_CARS = (
    {"namespace": "", "scan": "scan", "odom": "ego_racecar/odom", "drive": "drive", "base_frame": "ego_racecar/base_link"},
    {"namespace": "opp", "scan": "/opp_scan", "odom": "/opp_racecar/odom", "drive": "/opp_drive",
     "base_frame": "opp_racecar/base_link"},
)
GYM = {"localise": "false", "rear_axle": "-0.17145", "scan_interval": "0.023"}


def include(package, file, **arguments):
    folder = os.path.join(get_package_share_directory(package), "launch")
    return IncludeLaunchDescription(PythonLaunchDescriptionSource(os.path.join(folder, file)),
                                    launch_arguments=arguments.items())


def rviz():
    file = os.path.join(get_package_share_directory("slalom_ros"), "rviz", "slalom.rviz")
    return Node(package="rviz2", executable="rviz2", arguments=["-d", file])


def in_gym(given):
    if given["cars"] not in ("1", "2"):
        raise ValueError(f"cars: '{given['cars']}' must be 1 or 2")
    planner = {name: given[name] for name in ("course", "configuration", "method", "max_speed")}
    actions = [include("slalom_ros", "car.launch.py", **planner, **GYM, **car) for car in GYM_CARS[:int(given["cars"])]]
    if given["start_gym"] == "true":
        actions.append(include("f1tenth_gym_ros", "gym_bridge_launch.py"))
    return actions


def in_slalom(given):
    world = {"autostart": True, "course": given["course"], "obstacles": int(given["obstacles"]), "seed": int(given["seed"])}
    car = {name: given[name] for name in ("course", "configuration", "method", "max_speed")}
    car.update(localise="true", everywhere="true", pose_file="")
    if given["composed"] == "true":
        node = ComposableNode(package="slalom_ros", plugin="slalom_ros::WorldNode", name="world", parameters=[world])
        return [ComposableNodeContainer(name="slalom", namespace="", package="rclcpp_components", output="screen",
                                        executable="component_container_isolated", composable_node_descriptions=[node]),
                include("slalom_ros", "car.launch.py", container="slalom", **car)]
    return [Node(package="slalom_ros", executable="world_node", name="world", parameters=[world], output="screen"),
            include("slalom_ros", "car.launch.py", **car)]


def everything(context):
    given = {name: context.launch_configurations[name] for name, _, _ in ARGUMENTS}
    simulators = {"slalom": in_slalom, "f1tenth_gym": in_gym}
    if given["simulator"] not in simulators:
        raise ValueError(f"simulator: '{given['simulator']}' must be one of {', '.join(simulators)}")
    return simulators[given["simulator"]](given) + ([rviz()] if given["rviz"] == "true" else [])


def generate_launch_description():
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=text) for name, default, text in ARGUMENTS),
        OpaqueFunction(function=everything)])
