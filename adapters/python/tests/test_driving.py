import importlib.util
import signal
import time

import numpy as np
import pytest
import slalom

pytest.importorskip("slalom._driving")


KINEMATIC = {"horizon": 14, "samples": 1000, "temperature": 3, "input_min": -0.4189, "input_max": 0.4189,
             "guide_step": 0.005, "guide_variance": 0.01, "gradient_variance": 0.01, "gradient_temperature": 3,
             "variance_min": 0.001, "variance_max": 0.1}


def test_a_lap_is_driven_and_counted():
    course = slalom.Course("wren")
    assert course.waypoints.shape[1] == 4 and course.length > 10
    lap, same = (slalom.drive_lap(course, "svg_mppi", seed=1, options=KINEMATIC) for _ in range(2))
    assert lap["finished"] and lap["collisions"] == 0 and len(lap["solve_ms"]) == lap["steps"]
    assert lap["path"].shape == (lap["steps"], 4) and lap["obstacles"].shape == (0, 3)
    assert np.mean(lap["path"][:, 3]) == pytest.approx(lap["mean_speed"], rel=0.02)
    assert same["time"] == lap["time"] and same["mean_sequence_cost"] == lap["mean_sequence_cost"]


def test_a_planner_drives_by_scan_and_odometry():
    course = slalom.Course("wren")
    planner, world = slalom.Planner(course, "svg_mppi", KINEMATIC), slalom.World(course)
    world.reset(1, [course.start])
    for _ in range(120):
        seen = world.observe()
        x, y, yaw = seen["pose"]
        rear = (x - 0.17145 * np.cos(yaw), y - 0.17145 * np.sin(yaw), yaw)
        scan = {name: seen[name] for name in ("angle_min", "angle_increment", "range_max")}
        command = planner.update(seen["ranges"], **scan, pose=rear, speed=seen["speed"])
        assert command["status"] == "ok" and command["predicted"].shape[1] == 4
        world.step([(command["steer"], command["speed"])], steps=5)
        assert not world.observe()["contact"]
    assert world.observe()["progress"] > 2


def test_a_planner_takes_every_input():
    course = slalom.Course("wren")
    world = slalom.World(course)
    world.reset(1, [course.start])
    seen = world.observe()
    x, y, yaw = course.start
    scan = {name: seen[name] for name in ("angle_min", "angle_increment", "range_max")}
    ahead = [[(x + 2 * np.cos(yaw), y + 2 * np.sin(yaw), yaw, 0.05, 0.05)] * 10]
    inputs = {"covariance": np.diag([0.01, 0.01, 0.01]), "obstacles": [(1.2, -0.1), (1.2, 0), (1.2, 0.1)],
              "imu": (0.5, 1, 0.2), "others": [slalom.PredictedObstacle(ahead, length=0.5, width=0.3)],
              "obeyed": (0.3, 2), "goal_speed": 0.5}

    def command(**more):
        planner = slalom.Planner(course, "svg_mppi", {"samples": 256}, config="default")
        for _ in range(3):
            made = planner.update(seen["ranges"], **scan, pose=(x, y, yaw), speed=1.5, **more)
        return made["steer"], made["speed"]

    assert command() == command(goal_speed=1000)
    for name, value in inputs.items():
        assert command() != command(**{name: value}), name


def test_a_configuration_drives_a_lap():
    lap = slalom.drive_lap(slalom.Course("wren"), "svg_mppi", seed=1, config="default", options={"samples": 256})
    if importlib.util.find_spec("matplotlib"):
        assert slalom.plot.lap(lap).axes[0].get_title().startswith("finished, ")
        assert lap._repr_png_().startswith(b"\x89PNG")
    assert lap["finished"] and lap["collisions"] == 0


def test_errors_name_the_mistake():
    course = slalom.Course("wren")
    world = slalom.World(course)
    world.reset(0, [course.start])
    for call, error, words in [
            (lambda: slalom.Course("nowhere_to_be_found"), slalom.IoError, "nowhere_to_be_found"),
            (lambda: slalom.drive_lap(course, config="no_such_configuration"), slalom.IoError, "no_such_configuration"),
            (lambda: slalom.Planner(course, "no_method"), ValueError, "method"),
            (lambda: slalom.Planner(course, options={"samples": 0}), ValueError, "samples"),
            (lambda: slalom.drive_lap(course, options={"world.friction": -1}), ValueError, "world.friction"),
            (lambda: world.step([]), ValueError, "commands"), (lambda: world.step([(0, 1), (0, 1)]), ValueError, "commands"),
            (lambda: world.step([(0, np.nan)]), ValueError, "commands"),
            (lambda: world.step([(0, 1)], steps=-1), ValueError, "steps: -1 must be at least 0")]:
        with pytest.raises(error, match=words):
            call()
    assert world.time == 0.0


@pytest.mark.parametrize("call", ["step", "drive_lap", "solve", "solve_batch"])
def test_a_signal_ends_a_long_call(call):
    course = slalom.Course("wren")
    world = slalom.World(course)
    world.reset(0, [course.start])
    slow = slalom.Cem(slalom.Quadrotor(), horizon=500, samples=4_000_000, iterations=1000)
    state = [0.0] * slow.problem.states
    run = {"step": lambda: world.step([(0, 0)], steps=10**9),
           "drive_lap": lambda: slalom.drive_lap(course, "mppi", options={"samples": 64, "world.rounds": 100}),
           "solve": lambda: slow.solve(state), "solve_batch": lambda: slalom.solve_batch([slow], [state])}[call]
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    begin = time.process_time()
    try:
        with pytest.raises(KeyboardInterrupt):
            run()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert time.process_time() - begin < 10


def test_a_world_takes_the_options_of_the_simulator():
    course = slalom.Course("wren")
    world = slalom.World(course, beams=27, friction=0.4, wall_response="slide", model="saturating")
    chosen = {"beams": 27, "friction": 0.4, "wall_response": "slide", "model": "saturating", "time_step": 0.005}
    assert chosen.items() <= world.options.items() and slalom.World(course).options["body_response"] == "slide"
    for changes, error, text in [({"beam": 3}, TypeError, "unknown option 'beam'; did you mean 'beams'"),
                                 ({"beams": 0}, ValueError, "beams"), ({"model": "rail"}, ValueError, "World.model")]:
        with pytest.raises(error, match=text):
            slalom.World(course, **changes)

    def speed_after_half_a_second(**options):
        world = slalom.World(course, beams=3, **options)
        world.reset(0, [course.start])
        world.step([(0.0, 2.0)], steps=100)
        return world.observe()["speed"]

    assert speed_after_half_a_second(acceleration_max=1) < 0.6 < 1.5 < speed_after_half_a_second()
