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
                        ([nn.Linear(3, 4), nn.Softplus(beta=2)], "must have beta=1"),
                        ([nn.Linear(3, 4), nn.Tanh(), nn.Linear(4, 4), nn.ReLU()], "not tanh and relu"),
                        ([nn.Linear(3, 4), nn.Linear(3, 2)], "do not fit to 4 values"), ([nn.Tanh()], "no torch.nn.Linear")]:
        with pytest.raises(ValueError, match=text):
            to_mlp(nn.Sequential(*parts))


@pytest.mark.parametrize("activation", ["Tanh", "ReLU", "Softplus", "SiLU"])
def test_a_network_that_torch_exports_to_onnx_becomes_one_of_ours(activation, tmp_path):
    torch = pytest.importorskip("torch")
    pytest.importorskip("onnx")
    from slalom.onnx import load_mlp

    class Normalised(torch.nn.Module):
        def __init__(self):
            super().__init__()
            nn = torch.nn
            self.layers = nn.Sequential(nn.Linear(3, 8), getattr(nn, activation)(), nn.Linear(8, 5, bias=False),
                                        getattr(nn, activation)(), nn.Linear(5, 2))
            self.mean, self.scale = torch.tensor([1.0, -2.0, 0.5]), torch.tensor([0.3, 2.0, 1.5])
            self.shift = torch.tensor([0.1, -0.2])

        def forward(self, x):
            return 3 * self.layers((x - self.mean) / self.scale) + self.shift

    torch.manual_seed(2)
    network = Normalised().eval()
    expected = network(torch.from_numpy(points())).detach().numpy()
    torch.onnx.export(network, torch.zeros(1, 3), str(tmp_path / "network.onnx"), dynamic_axes={"x": {0: "samples"}},
                      input_names=["x"])
    np.testing.assert_allclose(load_mlp(tmp_path / "network.onnx")(points()), expected, atol=1e-5)
    assert [len(biases) for _, biases in load_mlp(tmp_path / "network.onnx").layers] == [8, 5, 2]


def graph(*nodes, output="y", inputs=("x",), width=3):
    """The bytes of an ONNX file; its constants are W [3, 2], b [2] and c [3]."""
    onnx = pytest.importorskip("onnx")
    helper, numbers = onnx.helper, onnx.TensorProto.FLOAT
    constants = {"W": np.arange(6).reshape(3, 2) / 4, "b": np.array([1.0, -1.0]), "c": np.array([2.0, 4.0, 0.5])}
    made = helper.make_graph(
        [helper.make_node(kind, list(entering), [leaving], name=f"n{i}", **attributes)
         for i, (kind, entering, leaving, attributes) in enumerate(nodes)], "g",
        [helper.make_tensor_value_info(name, numbers, ["K", width]) for name in inputs],
        [helper.make_tensor_value_info(output, numbers, ["K", 2])],
        [onnx.numpy_helper.from_array(value.astype(np.float32), name) for name, value in constants.items()])
    return helper.make_model(made).SerializeToString(), constants


def test_every_part_of_an_onnx_chain_is_read(tmp_path):
    file = tmp_path / "network.onnx"
    content, k = graph(("Sub", "cx", "p", {}), ("Div", "pc", "q", {}), ("MatMul", "qW", "r", {}), ("Add", "br", "s", {}),
                       ("Identity", "s", "t", {}), ("Tanh", "t", "u", {}), ("Mul", "bu", "y", {}))
    pytest.importorskip("onnx")
    from slalom.onnx import load_mlp
    file.write_bytes(content)
    expected = k["b"] * np.tanh((k["c"] - points()) / k["c"] @ k["W"] + k["b"])
    np.testing.assert_allclose(load_mlp(file)(points()), expected, atol=1e-5)
    content, k = graph(("Gemm", "xWb", "y", {"alpha": 0.5, "beta": 2.0}))
    file.write_bytes(content)
    np.testing.assert_allclose(load_mlp(file)(points()), 0.5 * points() @ k["W"] + 2 * k["b"], atol=1e-5)
    np.testing.assert_allclose(load_mlp(file, residual=True)(points()),
                               0.5 * points() @ k["W"] + 2 * k["b"] + points()[:, :2], atol=1e-5)


def test_mistakes_in_an_onnx_file_name_the_file_and_the_node(tmp_path):
    pytest.importorskip("onnx")
    from slalom.onnx import load_mlp

    file = tmp_path / "network.onnx"
    for made, text in [
            (graph(("Softmax", "x", "y", {})), r"network.onnx: node 'n0' \(Softmax\): is not a part of an Mlp"),
            (graph(("Tanh", "x", "p", {}), ("Add", "px", "y", {})), r"node 'n1' \(Add\): must have the result"),
            (graph(("Gemm", "xWb", "p", {"transB": 1})), r"weights \(3, 2\).* do not fit to 3 values"),
            (graph(("MatMul", "xW", "p", {}), ("Mul", "pc", "y", {})), r"shape \(3,\) does not fit to 2 values"),
            (graph(("Tanh", "x", "p", {}), ("Relu", "p", "y", {})), "not tanh and relu"),
            (graph(("Tanh", "x", "p", {})), "output 'y' is not the end"),
            (graph(("Gemm", "xWb", "y", {}), inputs=("x", "z")), "has 2 inputs and 1 outputs"),
            (graph(("Gemm", "xWb", "y", {}), width="n"), "with a known n")]:
        file.write_bytes(made[0])
        with pytest.raises(ValueError, match=text):
            load_mlp(file)
    file.write_bytes(b"not a graph")
    with pytest.raises(ValueError, match="is not an ONNX file"):
        load_mlp(file)
    with pytest.raises(FileNotFoundError):
        load_mlp(tmp_path / "absent.onnx")
