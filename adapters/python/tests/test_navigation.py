import numpy as np
import pytest
import slalom

pytest.importorskip("slalom._driving")


def room():
    cells = np.zeros((60, 100), dtype=bool)
    cells[20:40, 45:50] = True
    return slalom.OccupancyGrid(cells, 0.1)


def drive(seed, cost=None):
    costmap, body = slalom.Costmap(room()), slalom.Footprint.rectangle(0.3, 0.3, 0.4)
    navigator = slalom.Navigator(body, costmap, max_forward=0.8, solver={"samples": 500})
    navigator.set_cost(cost)
    navigator.reset(seed)
    pose, velocity, trace = np.array([1.0, 3.0, 0.0]), (0.0, 0.0, 0.0), []
    path = slalom.plan_path(costmap, body, pose, (9, 3, 1))
    assert path.shape[1] == 3 and np.allclose(path[-1], (9, 3, 1))
    navigator.set_path(path)
    for _ in range(600):
        result = navigator.update(pose, velocity, costmap, 0.05)
        if result["status"] == "goal_reached":
            break
        assert not costmap.collides(body, pose)
        velocity = result["command"]
        forward, _, turn = velocity
        pose = pose + 0.05 * np.array([forward * np.cos(pose[2]), forward * np.sin(pose[2]), turn])
        trace.append(pose)
    assert result["status"] == "goal_reached" and result["delay"] == 0
    assert np.linalg.norm(pose[:2] - (9, 3)) < 0.15 and abs(pose[2] - 1) < 0.2
    return np.array(trace)


def test_a_robot_drives_round_a_block_to_its_goal_and_repeats():
    assert np.array_equal(drive(1), drive(1))


def test_a_cost_of_ones_own_slows_the_robot():
    steps = set()

    def slow(x, y, yaw, forward, left, turn, step):
        steps.add(step)
        assert x.shape == y.shape == yaw.shape == left.shape == turn.shape
        return np.where(x > 7, 30 * np.maximum(forward - 0.3, 0), 0)

    def speed(trace):
        steps = np.linalg.norm(np.diff(trace[:, :2], axis=0), axis=1)
        return np.max(steps[(trace[1:, 0] > 7.2) & (trace[1:, 0] < 8)]) / 0.05

    assert speed(drive(1)) > 0.7 and speed(drive(1, slow)) < 0.4
    assert steps == set(range(56))


def test_people_of_ones_own_detector_are_met_where_they_will_be():
    def nearest(told):
        costmap, body = slalom.Costmap(slalom.OccupancyGrid(np.zeros((60, 100), bool), 0.1)), slalom.Footprint.rectangle(
            0.3, 0.3, 0.4)
        navigator = slalom.Navigator(body, costmap, solver={"samples": 500})
        navigator.reset(1)
        navigator.set_path([(1, 3, 0), (8, 3, 0)])
        pose, velocity, least = np.array([1.0, 3.0, 0.0]), (0.0, 0.0, 0.0), 9.0
        for step in range(200):
            person = np.array([4, 0.4 + 0.42 * 0.05 * step])
            way = [[(4, person[1] + 0.42 * 0.1 * k, np.pi / 2, 0.02, 0.02) for k in range(30)]]
            others = [slalom.PredictedObstacle(way, length=0.5, width=0.5)] if told else []
            velocity = navigator.update(pose, velocity, costmap, 0.05, others)["command"]
            turned = pose[2] + 0.025 * velocity[2]
            pose = pose + 0.05 * np.array([velocity[0] * np.cos(turned), velocity[0] * np.sin(turned), velocity[2]])
            least = min(least, np.linalg.norm(pose[:2] - person))
        return least

    assert nearest(False) < 0.45 < 0.55 < nearest(True)
    with pytest.raises(ValueError, match="must have shape"):
        slalom.PredictedObstacle(np.zeros((1, 3, 2)), length=1, width=1)


def test_errors_of_a_cost_reach_the_caller():
    for function, error, words in [(lambda *_: np.zeros(3), ValueError, "must return one number, or shape"),
                                   (lambda *_: 1 / 0, ZeroDivisionError, "division")]:
        with pytest.raises(error, match=words):
            drive(1, function)
    assert np.array_equal(drive(1), drive(1, lambda *_: 0))


def test_errors_name_the_argument_and_the_rule():
    costmap, body = slalom.Costmap(room(), unknown="priced"), slalom.Footprint([[0.2, 0.2], [-0.2, 0.2], [0, -0.3]])
    assert costmap.distance(1, 1) > 0.5
    assert slalom.plan_path(costmap, body, (1, 3, 0), (4.7, 3, 0)).shape == (0, 3)
    navigator = slalom.Navigator(body, costmap)
    for call, words in [(lambda: navigator.set_path(np.zeros((3, 2))), "path: has shape"),
                        (lambda: slalom.Costmap(room(), unknown="free"), "unknown: 'free' must be one of"),
                        (lambda: slalom.Navigator(body, costmap, max_forward=-1), "max_forward: '-1' must be in"),
                        (lambda: costmap.update(room(), np.zeros(7)), "prices must have the size"),
                        (lambda: costmap.update(slalom.OccupancyGrid(np.zeros((3, 3)), 0.1)), "size and resolution")]:
        with pytest.raises(ValueError, match=words):
            call()
    with pytest.raises(TypeError, match="did you mean 'max_forward'"):
        slalom.Navigator(body, costmap, max_forwards=1)
