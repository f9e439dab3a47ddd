#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "slalom/core/error.hpp"
#include "slalom/core/network/mlp.hpp"
#include "support/npz_writer.hpp"
#include "support/temporary_folder.hpp"

namespace slalom {
namespace {

using testing::floats;
using testing::network_files;
using testing::npy;
using testing::text;
using testing::zip;
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

TEST_F(MlpFile, DamageIsFoundOrHarmless) {
  const std::string whole = zip(network_files());
  for (std::size_t size = 0; size < whole.size(); size += 23) EXPECT_NE(error(whole.substr(0, size)), "");
  std::mt19937 random(6);
  int found = 0;
  for (int trial = 0; trial < 250; ++trial) {
    std::string damaged = whole;
    for (int i = 0; i < 1 + trial % 3; ++i)
      damaged[random() % damaged.size()] ^= static_cast<char>(1 << random() % 8);
    found += error(damaged) != "";
  }
  EXPECT_GT(found, 213) << "of the rest, bits changed that are not read";
}

}  // namespace
}  // namespace slalom
