import numpy as np
import pytest
import slalom


def test_a_field_interpolates_its_samples():
    samples = np.arange(12.0).reshape(3, 4)
    field = slalom.Field(samples, resolution=0.5, origin=(1, 2))
    assert field.shape == (3, 4) and field.resolution == 0.5 and field.origin == (1, 2, 0)
    assert repr(field) == "<slalom.Field 3 x 4 of 0.5 m>"
    columns, rows = np.meshgrid(np.arange(4), np.arange(3))
    np.testing.assert_allclose(field.value(1.25 + 0.5 * columns, 2.25 + 0.5 * rows), samples)
    value, dx, dy = field.value_and_gradient(1.5, 2.5)
    assert (value, dx, dy) == pytest.approx((2.5, 2, 8))
    assert field.relative_to(1, 2).value(0.5, 0.5) == pytest.approx(2.5)


def test_a_field_of_a_function_is_that_function():
    field = slalom.Field.from_function(lambda x, y: 2 * x - y, width=30, height=20, resolution=0.1, origin=(-1, -1, 0.2))
    x, y = np.array([0.1, 0.4]), np.array([0.2, -0.1])
    for dtype in np.float64, np.float32:
        value, dx, dy = field.value_and_gradient(x.astype(dtype), y.astype(dtype))
        assert value.dtype == dx.dtype == dy.dtype == dtype
        np.testing.assert_allclose(value, 2 * x - y, atol=1e-4)
        np.testing.assert_allclose(dx, 2, rtol=1e-3)
        np.testing.assert_allclose(dy, -1, rtol=1e-3)


def test_signed_distance_of_occupancy():
    cells = np.zeros((20, 30), bool)
    cells[:, 10] = True
    field = slalom.signed_distance(slalom.OccupancyGrid(cells, 0.1), outside_is_obstacle=False)
    assert field.value(0.55, 1.0) == pytest.approx(0.45)  # the wall begins at x = 1 m
    assert field.value(1.05, 1.0) == pytest.approx(-0.05)


def test_a_ros_map_is_loaded(tmp_path):
    (tmp_path / "hall.pgm").write_bytes(b"P5\n3 2\n255\n" + bytes([0, 254, 254, 254, 205, 254]))
    (tmp_path / "hall.yaml").write_text("image: hall.pgm\nresolution: 0.2\norigin: [1, 2, 0]\nnegate: 0\n"
                                        "occupied_thresh: 0.65\nfree_thresh: 0.196\n")
    grid = slalom.load_ros_map(str(tmp_path / "hall.yaml"))
    assert grid.cells.tolist() == [[0, -1, 0], [100, 0, 0]]  # the first row of an image is the topmost
    assert grid.resolution == 0.2 and grid.origin == (1, 2, 0)
    with pytest.raises(slalom.IoError, match="missing.yaml"):
        slalom.load_ros_map(str(tmp_path / "missing.yaml"))


@pytest.mark.parametrize("make, text", [(lambda: slalom.Field([1.0, 2.0], 0.1), "has 1 dimensions, must have 2"),
    (lambda: slalom.Field([[1.0, np.nan]], 0.1), "row 0, column 1: nan: must be a finite float32 value"),
    (lambda: slalom.Field([[1.0]], 0), "field.resolution: 0: must be finite and above 0"),
    (lambda: slalom.Field([[1.0]], 1, (1,)), "origin: has 1 values, must have 2 or 3"),
    (lambda: slalom.Field.from_function(lambda x, y: x[0], 3, 2, 1), r"must return an array of shape \(2, 3\)"),
    (lambda: slalom.Field.from_function(lambda x, y: x, 0, 2, 1), "0 x 2 cells must be at least 1 x 1"),
    (lambda: slalom.Field([[1.0]], 1).value([1, 2], [1, 2, 3]), "x, y: must have the same shape"),
    (lambda: slalom.OccupancyGrid([[0, 101]], 1), r"101 must be in \[-1, 100\]"),
    (lambda: slalom.OccupancyGrid([0, 100], 1), "has 1 dimensions, must have 2"),
    (lambda: slalom.signed_distance(slalom.OccupancyGrid([[0]], -1)), "map: resolution -1 must be finite and above 0"),])
def test_what_is_no_map_is_rejected(make, text):
    with pytest.raises(ValueError, match=text):
        make()
