import math

import numpy as np
import pytest
import slalom
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


def test_a_network_is_stored_and_read(tmp_path):
    x = np.random.default_rng(4).normal(size=(200, 3))
    network = train_mlp(x, function(x), hidden=(8, 4), residual=True, epochs=2)
    network.save(tmp_path / "network.npz")
    with np.load(tmp_path / "network.npz", allow_pickle=False) as arrays:
        assert arrays["weights_0"].shape == (8, 3) and arrays["biases_2"].shape == (2,)
        assert str(arrays["activation"]) == "tanh" and arrays["residual"]
    assert np.array_equal(Mlp.load(tmp_path / "network.npz")(x), network(x))
    with pytest.raises(slalom.IoError, match="none.npz: .*exist"):
        Mlp.load(tmp_path / "none.npz")


def test_mistakes_are_named():
    for call, words in [(lambda: Mlp([(np.zeros((1, 1)), np.zeros(1))], "sine"), "'sine' must be one of tanh, relu, softplus, silu"),
                        (lambda: train_mlp(np.zeros((3, 1)), np.zeros((2, 1))), r"inputs \(3, 1\) and outputs \(2, 1\) must be arrays"),
                        (lambda: train_mlp(np.full((3, 1), np.nan), np.zeros((3, 1))), "must be finite"),
                        (lambda: train_mlp(np.zeros((3, 1)), np.zeros((3, 2)), residual=True), "residual")]:
        with pytest.raises(ValueError, match=words):
            call()
    for mistake in [{"hidden": (0,)}, {"hidden": (8, -1)}, {"learning_rate": math.nan}, {"learning_rate": 0}, {"batch": 0},
                    {"epochs": 1.5}]:
        with pytest.raises(ValueError, match=f"train_mlp: {next(iter(mistake))}: .* must be"):
            train_mlp(np.zeros((3, 1)), np.zeros((3, 1)), **mistake)


def points():
    return np.random.default_rng(6).normal(size=(50, 3)).astype(np.float32)


@pytest.mark.parametrize("activation", ["Tanh", "ReLU", "Softplus", "SiLU"])
def test_a_network_of_torch_becomes_one_of_ours(activation, tmp_path):
    torch = pytest.importorskip("torch")
    from slalom.torch import to_mlp

    torch.manual_seed(1)
    nn = torch.nn
    network = nn.Sequential(nn.Linear(3, 8), getattr(nn, activation)(), nn.Dropout(), nn.Linear(8, 5, bias=False),
                            getattr(nn, activation)(), nn.Linear(5, 2)).eval()
    expected = network(torch.from_numpy(points())).detach().numpy()
    np.testing.assert_allclose(to_mlp(network)(points()), expected, atol=1e-6)
    np.testing.assert_allclose(to_mlp(network, residual=True)(points()), expected + points()[:, :2], atol=1e-6)
    to_mlp(network).save(tmp_path / "network.npz")
    np.testing.assert_allclose(Mlp.load(tmp_path / "network.npz")(points()), expected, atol=1e-6)


def test_what_is_no_mlp_of_torch_is_named():
    nn = pytest.importorskip("torch").nn
    from slalom.torch import to_mlp

    for parts, text in [([nn.Linear(3, 4), nn.LayerNorm(4)], "part 1: LayerNorm.* must be Linear"),
                        ([nn.Linear(3, 4), nn.Softplus(beta=2)], "part 1: Softplus"),
                        ([nn.Linear(3, 4), nn.Linear(4, 2)], "part 1: Linear"),
                        ([nn.Linear(3, 4), nn.Tanh(), nn.Linear(4, 4), nn.ReLU(), nn.Linear(4, 1)], "the same activation"),
                        ([nn.Linear(3, 4), nn.Tanh()], "the same activation")]:
        with pytest.raises(ValueError, match=text):
            to_mlp(nn.Sequential(*parts))
