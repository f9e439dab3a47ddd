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

    assert speed(drive(1)) > 0.7 and speed(drive(1, slow)) < 0.4 and steps == set(range(56))


def scan(pose, person, radius=0.25):
    """720 ranges all around in a room of 10 x 6 m with a person."""
    angles = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    way, to = np.array([np.cos(angles), np.sin(angles)]), person - pose[:2]
    walls = [(edge - pose[i]) / np.where(way[i] == 0, 1e-9, way[i]) for i, size in enumerate((10, 6)) for edge in (0, size)]
    along, off = to @ way, to[0] * way[1] - to[1] * way[0]
    hit = np.where((along > 0) & (abs(off) < radius), along - np.sqrt(np.maximum(radius**2 - off**2, 0)), 99)
    return {"ranges": np.minimum(hit, np.where(np.array(walls) > 0, walls, 99).min(axis=0)), "angle_min": -np.pi,
            "angle_increment": np.pi / 360, "range_max": 15.0}


def test_people_in_scans_are_tracked_and_predicted():
    tracker, predictor, pose = slalom.ObjectTracker(people=True, min_points=4), slalom.Predictor(people=True), np.array([2, 3, 0])
    for stamp in np.arange(0, 4, 0.05):
        person = np.array([4, 0.5 + 0.6 * stamp])
        seen = tracker.update(**scan(pose, person), pose=pose, stamp=stamp)
        others = predictor.update(seen["objects"], stamp)
    [found], [other] = seen["objects"], others
    assert seen["status"] == "ok" and seen["pose"] == tuple(pose) and found.unseen == 0 and 0.4 < found.width < 0.6
    assert np.hypot(*(found.pose[:2] - person)) < 0.1 and found.speed == pytest.approx(0.6, abs=0.1) and found.covariance[3, 3] > 0
    assert np.allclose(other.poses[np.argmax(other.weights), 10, :2], person + [0, 0.6], atol=0.15), "a second later"
    seen = scan(pose, person)
    kept = slalom.drop_readings_of(others, seen["ranges"], angle_min=-np.pi, angle_increment=np.pi / 360, pose=pose)
    on_person = seen["ranges"] < scan(pose, np.array([50, 50]))["ranges"] - 0.1
    assert on_person.sum() > 5 and np.isnan(kept[on_person]).all() and np.isnan(kept).sum() < on_person.sum() + 9
    seen = tracker.update(**seen, pose=pose, stamp=4)
    with pytest.raises(TypeError, match="others: .*_driving.PredictedObstacle"):
        slalom.Navigator.update(others=seen["objects"])
    thing, box = {"id": 1, "pose": (0, 0, 0), "speed": 1}, {"poses": np.zeros((3, 5)), "length": 1, "width": 1}
    assert slalom.PredictedObstacle(**box).poses.shape == (1, 3, 5) and slalom.TrackedObject(**thing).id == 1
    for make, given, words in [
            (slalom.PredictedObstacle, {**box, "poses": np.zeros((1, 3, 2))}, "shape must be"),
            (slalom.PredictedObstacle, {**box, "poses": np.full((3, 5), np.nan)}, "poses: must be finite"),
            (slalom.PredictedObstacle, {**box, "weights": [np.inf]}, "weights: must be finite"),
            (slalom.PredictedObstacle, {**box, "width": np.nan}, "width, interval: must be finite"),
            (slalom.PredictedObstacle, {**box, "interval": 0}, "must be positive"),
            (slalom.TrackedObject, {**thing, "pose": (0, np.nan, 0)}, "TrackedObject.pose"),
            (slalom.TrackedObject, {**thing, "speed": np.nan}, "sizes and speeds: must be finite"),
            (slalom.TrackedObject, {**thing, "speed": -0.1}, "speed must be at least 0; who moves backwards"),
            (slalom.TrackedObject, {**thing, "length": -1}, "length, width and speed must be at least 0"),
            (predictor.update, {"objects": [], "stamp": np.nan}, "update: stamp: must be finite"),
            (predictor.update, {"objects": [found, found], "stamp": 9}, f"the id {found.id} must be that of one object"),
            (slalom.TrackedObject, {**thing, "covariance": np.full((5, 5), np.nan)}, "covariance: must be finite"),
            (slalom.ObjectTracker, {"gate": 0}, "gate: '0' must be in"), (slalom.Predictor, {"course": [(0, 0, 0, 1)]}, "path")]:
        with pytest.raises(ValueError, match=words):
            make(**given)


def test_errors_of_a_cost_reach_the_caller():
    for function, error, words in [(lambda *_: np.zeros(3), ValueError, "must return one number, or shape"),
                                   (lambda *_: 1 / 0, ZeroDivisionError, "division")]:
        with pytest.raises(error, match=words):
            drive(1, function)
    assert np.array_equal(drive(1), drive(1, lambda *_: 0))


def test_errors_name_the_argument_and_the_rule():
    costmap, body = slalom.Costmap(room(), unknown="priced"), slalom.Footprint([[0.2, 0.2], [-0.2, 0.2], [0, -0.3]])
    assert costmap.distance(1, 1) > 0.5 and slalom.plan_path(costmap, body, (1, 3, 0), (4.7, 3, 0)).shape == (0, 3)
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
