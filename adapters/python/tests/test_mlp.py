import numpy as np
import pytest
from slalom.mlp import Mlp, train_mlp


def function(x):
    return np.stack([np.sin(x[:, 0]) * x[:, 1], 3 + 0.1 * x[:, 1] ** 2]).T


@pytest.mark.parametrize("activation", ["tanh", "relu", "softplus", "silu"])
@pytest.mark.parametrize("residual", [False, True])
def test_a_network_learns_a_function(activation, residual):
    random = np.random.default_rng(1)
    x, unseen = random.uniform(-2, 2, (2000, 3)), random.uniform(-2, 2, (500, 3))
    network = train_mlp(x, function(x), hidden=(16, 16), activation=activation, residual=residual, epochs=60)
    error = np.sqrt(np.mean((network(unseen) - function(unseen)) ** 2))
    assert error < 0.12 * function(unseen).std()
    single = network(unseen.astype(np.float32))
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, network(unseen), atol=1e-4)


def test_the_same_seed_gives_the_same_network():
    x = np.random.default_rng(2).normal(size=(300, 2))
    first, again, other = (train_mlp(x, function(x), hidden=(8,), epochs=3, seed=seed)(x) for seed in (4, 4, 5))
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_columns_that_do_not_vary_are_allowed():
    x = np.random.default_rng(3).normal(size=(300, 2))
    x[:, 1] = 5
    network = train_mlp(x, x[:, 1:] * 2, hidden=(4,), epochs=3)
    np.testing.assert_allclose(network(x), 10, atol=1e-3)


def test_a_network_is_stored_and_read(tmp_path):
    x = np.random.default_rng(4).normal(size=(200, 3))
    network = train_mlp(x, function(x), hidden=(8, 4), residual=True, epochs=2)
    network.save(tmp_path / "network.npz")
    with np.load(tmp_path / "network.npz", allow_pickle=False) as arrays:
        assert arrays["weights_0"].shape == (8, 3) and arrays["biases_2"].shape == (2,)
        assert str(arrays["activation"]) == "tanh" and arrays["residual"]
    assert np.array_equal(Mlp.load(tmp_path / "network.npz")(x), network(x))


def test_mistakes_are_named():
    with pytest.raises(ValueError, match="'sine' must be one of tanh, relu, softplus, silu"):
        Mlp([(np.zeros((1, 1)), np.zeros(1))], "sine")
    with pytest.raises(ValueError, match=r"inputs \(3, 1\) and outputs \(2, 1\) must be arrays"):
        train_mlp(np.zeros((3, 1)), np.zeros((2, 1)))
    with pytest.raises(ValueError, match="must be finite"):
        train_mlp(np.full((3, 1), np.nan), np.zeros((3, 1)))
    with pytest.raises(ValueError, match="residual"):
        train_mlp(np.zeros((3, 1)), np.zeros((3, 2)), residual=True)
