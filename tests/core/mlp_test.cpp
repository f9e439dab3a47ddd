#include "slalom/core/network/mlp.hpp"

#include <functional>

#include "slalom/core/derivatives/linearize.hpp"
#include "slalom/core/error.hpp"
#include "support/npz_writer.hpp"
#include "support/rollouts.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_words.hpp"

namespace slalom {
namespace {

/// Parameters with all parts, drawn from a seed.
MlpParameters random_parameters(std::vector<int> sizes, Activation activation, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 0.4);
  const auto draw = [&](int count, double around) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(around + normal(random));
    return values;
  };
  MlpParameters p;
  p.activation = activation;
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i)
    p.layers.push_back({sizes[i], sizes[i + 1], draw(sizes[i] * sizes[i + 1], 0), draw(sizes[i + 1], 0)});
  p.input_mean = draw(sizes.front(), 0.5);
  p.input_scale = draw(sizes.front(), 3);
  p.output_mean = draw(sizes.back(), 1);
  p.output_scale = draw(sizes.back(), 2);
  return p;
}

/// The network as its definition says, in double.
std::vector<double> reference(const MlpParameters& p, const std::vector<double>& x) {
  std::vector<double> values = x;
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = (x[i] - p.input_mean[i]) / p.input_scale[i];
  for (std::size_t l = 0; l < p.layers.size(); ++l) {
    const auto& layer = p.layers[l];
    std::vector<double> next = layer.biases;
    for (std::size_t row = 0; row < next.size(); ++row) {
      for (std::size_t i = 0; i < values.size(); ++i)
        next[row] += layer.weights[row * values.size() + i] * values[i];
      if (l + 1 == p.layers.size()) continue;
      const double s = next[row];
      next[row] = p.activation == Activation::tanh       ? std::tanh(s)
                  : p.activation == Activation::relu     ? std::max(s, 0.0)
                  : p.activation == Activation::softplus ? std::log1p(std::exp(s))
                                                         : s / (1 + std::exp(-s));
    }
    values = next;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = values[i] * p.output_scale[i] + p.output_mean[i];
    if (p.residual) values[i] += x[i];
  }
  return values;
}

class Activations : public ::testing::TestWithParam<Activation> {};
INSTANTIATE_TEST_SUITE_P(All, Activations,
                         ::testing::Values(Activation::tanh, Activation::relu, Activation::softplus,
                                           Activation::silu));

TEST_P(Activations, AreThoseOfTheDefinition) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, 4);
  for (const bool residual : {false, true}) {
    for (const std::vector<int>& hidden : {std::vector<int>{}, {1}, {9}, {32, 32}, {5, 64, 3, 8}}) {
      std::vector<int> sizes{3};
      sizes.insert(sizes.end(), hidden.begin(), hidden.end());
      sizes.push_back(2);
      MlpParameters p = random_parameters(sizes, GetParam());
      p.residual = residual;
      const Mlp<3, 2> network(p);
      for (int trial = 0; trial < 20; ++trial) {
        const double x[] = {normal(random), normal(random), normal(random)};
        const auto expected = reference(p, {x[0], x[1], x[2]});
        const auto result = network(x[0], x[1], x[2]);
        for (int i = 0; i < 2; ++i) EXPECT_NEAR(result[i], expected[i], 2e-5) << hidden.size();
      }
    }
  }
}

/// A state that a network moves.
struct Learned {
  template <class T>
  struct State {
    T x, y;
  };
  static constexpr int inputs = 1;
  Mlp<3, 2> network;
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    const auto next = network(s.x, s.y, u[0]);
    return {next[0], next[1]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return network(s.x, s.y, u[0])[0];
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return s.x + s.y;
  }
};

TEST_P(Activations, AreTheSameInLanesOfEveryInstructionSet) {
  const Mlp<3, 2> network(random_parameters({3, 32, 20, 2}, GetParam(), 3));
  SequenceBatch batch{1, 1, 100};
  std::mt19937 random(4);
  std::normal_distribution<float> normal(0, 30);
  for (int i = 0; i < batch.samples(); ++i) batch.data(0)[i] = normal(random);
  for (const auto target : testing::instruction_sets()) {
    ProblemEvaluator<Learned> evaluator({network}, target);
    evaluator.set_state({0.5, -1});
    const auto costs = testing::roll_out(evaluator, batch).costs;
    for (int i = 0; i < batch.samples(); ++i) {
      const auto u = testing::inputs_of<1>(batch, i);
      const double expected = predict(evaluator.problem(), {0.5, -1.0}, u.data(), 1, nullptr).value;
      EXPECT_NEAR(costs[i], expected, 2e-5 * (1 + std::abs(expected)))
          << simd::name(target) << " sample " << i;
    }
  }
}

TEST_P(Activations, HaveDerivatives) {
  const Learned problem{Mlp<3, 2>(random_parameters({3, 16, 2}, GetParam(), 5))};
  const Learned::State<double> x{0.3, -0.8};
  const Input<double, 1> u{{0.4}};
  const auto l = linearize(problem, x, u);
  const double h = 1e-5;
  const auto high = problem.step({x.x + h, x.y}, u), low = problem.step({x.x - h, x.y}, u);
  EXPECT_NEAR(l.state_jacobian[0][0], (high.x - low.x) / (2 * h), 1e-6);
  EXPECT_NEAR(l.state_jacobian[1][0], (high.y - low.y) / (2 * h), 1e-6);
  EXPECT_FALSE(l.kink);
}

std::string mistake(const std::function<void(MlpParameters&)>& change) {
  MlpParameters p = random_parameters({3, 4, 2}, Activation::tanh);
  change(p);
  return message_of([&] { Mlp<3, 2>{p}; });
}

TEST(Mlp, ParametersThatDoNotFitAreRejected) {
  EXPECT_EQ(mistake([](auto&) {}), "accepted");
  EXPECT_EQ(mistake([](auto& p) { p.layers.clear(); }), "mlp: has 0 layers, must have 1 to 8");
  EXPECT_EQ(mistake([](auto& p) { p.layers[0].inputs = 5; }),
            "mlp: weights_0: has 5 columns, must have 3, the inputs");
  EXPECT_EQ(mistake([](auto& p) { p.layers[1].inputs = 5; }),
            "mlp: weights_1: has 5 columns, must have 4, the rows of the layer before");
  EXPECT_EQ(mistake([](auto& p) { p.layers[0].outputs = 65; }),
            "mlp: weights_0: has 65 rows, must have 1 to 64");
  EXPECT_EQ(mistake([](auto& p) { p.layers.pop_back(); }),
            "mlp: the last layer has 4 rows, must have 2, the outputs");
  EXPECT_EQ(mistake([](auto& p) { p.layers[1].biases.pop_back(); }),
            "mlp: biases_1: has 1 values, must have 2");
  EXPECT_EQ(mistake([](auto& p) { p.layers[1].weights[3] = NAN; }),
            "mlp: weights_1: every value must be a finite float32");
  EXPECT_EQ(mistake([](auto& p) { p.input_scale[1] = 0; }), "mlp: input_scale: no value may be 0");
  EXPECT_EQ(mistake([](auto& p) { p.output_mean.pop_back(); }),
            "mlp: output_mean: has 1 values, must have 2");
  EXPECT_EQ(mistake([](auto& p) { p.output_scale[0] = 1e300; }),
            "mlp: output_scale: every value must be a finite float32");
  EXPECT_THROW((Mlp<1, 2>{[] {
                 MlpParameters p = random_parameters({1, 2}, Activation::tanh);
                 p.residual = true;
                 return p;
               }()}),
               std::invalid_argument);
}

using namespace testing;
using Files = testing::NpzArrays;

class MlpFile : public testing::TemporaryFolder {
 protected:
  /// Returns the message with which a file of these bytes is refused; empty if it is read.
  std::string error(const std::string& bytes) {
    const auto file = write("network.npz", bytes);
    try {
      load_mlp(file);
    } catch (const IoError& error) {
      const std::string text = error.what(), prefix = file.string() + ": ";
      EXPECT_EQ(text.substr(0, prefix.size()), prefix);
      return text.substr(prefix.size());
    }
    return "";
  }
  /// Returns the message for a network with one array replaced, or left out if `array` is empty.
  std::string error_with(const std::string& name, const std::string& array) {
    Files files = network_files();
    std::erase_if(files, [&](const auto& file) { return file.first == name; });
    if (!array.empty()) files.emplace_back(name, array);
    return error(zip(files));
  }
};

TEST_F(MlpFile, IsReadWithAllItsParts) {
  const MlpParameters p = load_mlp(write("network.npz", zip(network_files())));
  ASSERT_EQ(p.layers.size(), 2u);
  EXPECT_EQ(p.layers[0].weights, (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(p.layers[1].biases, (std::vector<double>{11}));
  EXPECT_EQ(p.activation, Activation::relu);
  EXPECT_EQ(p.input_mean, (std::vector<double>{0, 1, 0}));
  EXPECT_TRUE(p.output_mean.empty());
  EXPECT_TRUE(p.residual);
  const Mlp<3, 1> network(p);
  EXPECT_EQ(network(1.0, 2.0, 0.0)[0], 9 * (1 + 2 + 7) + 10 * (4 + 5 + 8) + 11 + 1);
}

TEST_F(MlpFile, MistakesAreNamed) {
  EXPECT_EQ(error_with("biases_0.npy", ""), "array 'biases_0' is missing");
  EXPECT_EQ(error_with("activation.npy", text("sine")),
            "array 'activation': 'sine' must be tanh, relu, softplus or silu");
  EXPECT_EQ(error_with("speed.npy", floats("1,", {1})), "array 'speed' is not known");
  EXPECT_EQ(error_with("biases_0.npy", floats("1, 2", {1, 2})),
            "array 'biases_0': has 2 dimensions, must have 1");
  EXPECT_EQ(error_with("biases_0.npy", floats("3,", {1, 2, 3})), "mlp: biases_0: has 3 values, must have 2");
  EXPECT_EQ(error_with("biases_0.npy", floats("3,", {1, 2})),
            "array 'biases_0': has another number of bytes than its header says");
  EXPECT_EQ(
      error_with("biases_0.npy", npy("<i8", "2,", std::string(16, '\0'))),
      "array 'biases_0': has the type <i8, must be float32, float64, bool or a single text, little-endian");
  EXPECT_EQ(error_with("note.txt", "hello"),
            "holds 'note.txt', which is not an array: the name must end in .npy");
  EXPECT_EQ(error_with("x.npy", "hello"), "array 'x': is cut off");
  EXPECT_EQ(error_with("x.npy", std::string(200, 'x')), "array 'x': is not a numpy array");
  EXPECT_EQ(error_with("x.npy", floats("99999999999999999999,", {})), "array 'x': has too many values");
  EXPECT_EQ(error_with("x.npy", floats("4000000, 4000000", {})), "array 'x': has too many values");
  EXPECT_EQ(error(zip(network_files(), 8)), "array 'weights_0' is compressed: write it with numpy.savez");
  EXPECT_EQ(error("no archive"), "is not an .npz file of numpy.savez, or is truncated");
  EXPECT_EQ(error(""), "is not an .npz file of numpy.savez, or is truncated");
  Files twice = network_files();
  twice.push_back(twice[0]);
  EXPECT_EQ(error(zip(twice)), "holds array 'weights_0' twice");
  EXPECT_EQ(error(zip(Files(300, {"a.npy", ""}))), "holds more than 256 arrays");
  EXPECT_THROW(load_mlp("/nowhere/network.npz"), IoError);
}

}  // namespace
}  // namespace slalom
