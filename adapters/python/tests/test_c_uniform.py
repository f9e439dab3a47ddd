import numpy as np
import pytest
import slalom


def drive_law(**options):
    drive = slalom.Mppi(slalom.DifferentialDrive(), horizon=20, samples=64, input_min=[0, -2], input_max=[1.5, 2],
                        nominal_from_proposals=True)
    return drive, slalom.CUniform(drive, [0, 0, 0], [0.3, 0.3, 0.5], [0, 0, 2 * np.pi], input_steps=5,
                                  input_values=[3, 5], **options)


def test_c_uniform_sequences_are_proposals():
    drive, law = drive_law(seed=1)
    drawn = law.draw(100)
    assert drawn.shape == (100, 20, 2) and law.levels == 4
    assert set(np.unique(drawn[:, :, 0])) == {0, 0.75, 1.5} and set(np.unique(drawn[:, :, 1])) == {-2, -1, 0, 1, 2}
    assert np.array_equal(drawn, np.repeat(drawn[:, ::5], 5, axis=1))
    last = law.masses(4)
    assert abs(last.sum() - 1) < 1e-9 and 0.5 * np.abs(last - 1 / len(last)).sum() < 0.3
    assert drive.solve([0, 0, 0], proposals=drawn).ok
    law.reset(1)
    assert np.array_equal(law.draw(100), drawn) and not np.array_equal(law.draw(100), drawn)


def test_c_uniform_takes_callables():
    walk = slalom.Problem(lambda x, u: x + u, lambda x, u: x[:, 0], states=2, inputs=2, dt=1)
    law = slalom.CUniform(slalom.Mppi(walk, horizon=3, input_min=-1, input_max=1), [0, 0], [1], input_steps=1,
                          input_values=2, coordinates=lambda x: [x[0] + 10 * x[1]])
    assert [len(law.masses(level)) for level in range(4)] == [1, 4, 9, 16]
    with pytest.raises(ValueError, match="coordinates: has 2 values, must have 1"):
        slalom.CUniform(slalom.Mppi(walk, input_min=-1, input_max=1), [0, 0], [1], coordinates=lambda x: [0, 1])


def test_mistakes_of_c_uniform_are_errors():
    drive, law = drive_law()
    for start, sizes, options, message in (
            ([0, 0], [1, 1, 1], {}, "start: has 2 values, must have 3"),
            ([0, 0, 0], [1, 1], {}, "coordinates: has 3 values, must have 2"),
            ([0, 0, 0], [1, 1, 0], {}, "c_uniform: the size 0 of a cell must be above 0 and finite"),
            ([0, 0, 0], [1, 1, 1], {"periods": [0]}, "periods: has 1 values, must have 3"),
            ([0, 0, 0], [1, 1, 1], {"sweeps": -1}, "c_uniform.sweeps: -1 must be in"),
            ([0, 0, 0], [0.1, 0.1, 0.1], {"cells": 50}, "c_uniform: there are more than 50 cells")):
        with pytest.raises(ValueError, match=message):
            slalom.CUniform(drive, start, sizes, **options)
    with pytest.raises(TypeError, match="CUniform.input_values: 'many' must be a number"):
        slalom.CUniform(drive, [0, 0, 0], [1, 1, 1], input_values="many")
    with pytest.raises(TypeError, match="controller must be a slalom.Controller"):
        slalom.CUniform(slalom.CartPole(), [0] * 4, [1] * 4)
    with pytest.raises(IndexError, match=r"level: 5 must be in \[0, 4\]"):
        law.masses(5)
    with pytest.raises(ValueError, match="sequences: -1 must be at least 0"):
        law.draw(-1)
