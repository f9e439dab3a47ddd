import pathlib

import numpy as np
import pytest
import slalom

pytest.importorskip("slalom._driving")
WREN = pathlib.Path(__file__).resolve().parents[3] / "courses" / "wren" / "map.yaml"


def ring(radius=5.0, half_width=1.0, count=100):
    angle = 2 * np.pi * np.arange(count) / count
    widths = np.full(count, half_width)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), widths, widths], axis=1)


def test_a_raceline_is_within_its_corridor_and_the_limits():
    car = slalom.RacingCar(friction=0.8, top_speed=7)
    line = slalom.raceline(ring(), car)
    s, x, y, yaw, curvature, speed, acceleration = line["points"].T
    inner = 4 + car.width / 2 + car.margin
    assert np.allclose(np.hypot(x, y), inner, atol=0.01)
    assert np.all(np.abs(speed**2 * curvature) <= 0.8 * 9.81 * (1 + 1e-9))
    assert line["closed"] and line["time"] == pytest.approx(2 * np.pi * np.sqrt(inner / (0.8 * 9.81)), abs=0.01)


def test_speeds_have_a_limit_at_each_curvature():
    curvature = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
    speeds = slalom.racing_speeds(curvature, np.full(5, 2.0), False, slalom.RacingCar(friction=0.4))
    assert speeds[2] == pytest.approx(np.sqrt(0.4 * 9.81)) and speeds[0] > speeds[2] < speeds[4]


def test_a_course_comes_from_a_map(tmp_path):
    made = slalom.race_course(str(WREN), slalom.RacingCar("f1tenth", margin=0.1), out=str(tmp_path / "made"))
    assert made["points"].shape[1] == 7 and made["centre_line"].shape[1] == 4
    assert np.min(made["distance"]) > 0.2
    assert slalom.Course(str(tmp_path / "made")).length == pytest.approx(made["length"], abs=0.01)


def test_mistakes_are_named():
    with pytest.raises(ValueError, match="tank"):
        slalom.RacingCar("tank")
    with pytest.raises(TypeError, match="wings"):
        slalom.RacingCar(wings=2)
    with pytest.raises(ValueError, match="points, 4"):
        slalom.raceline(np.zeros((5, 3)))
