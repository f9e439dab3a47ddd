#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "slalom/core/math.hpp"

namespace slalom {

/// The function that a neuron of a hidden layer applies to its weighted sum.
enum class Activation : std::uint8_t {
  tanh,
  relu,      ///< max(x, 0)
  softplus,  ///< log(1 + e^x)
  silu,      ///< x / (1 + e^-x)
};

inline const char* const* enum_names(Activation) {
  static constexpr const char* const names[] = {"tanh", "relu", "softplus", "silu", nullptr};
  return names;
}

/// The parameters of a network of dense layers, as they are trained and stored.
struct MlpParameters {
  /// One layer: weights [outputs][inputs] and biases [outputs].
  struct Layer {
    int inputs = 0;               ///< values that enter
    int outputs = 0;              ///< neurons
    std::vector<double> weights;  ///< row by row
    std::vector<double> biases;   ///< one for each neuron
  };
  std::vector<Layer> layers;                 ///< hidden layers, then the linear output layer
  Activation activation = Activation::tanh;  ///< activation of the hidden layers
  std::vector<double> input_mean;            ///< subtracted from the inputs; empty: 0
  std::vector<double> input_scale;           ///< divides them then; empty: 1
  std::vector<double> output_scale;          ///< multiplies the outputs; empty: 1
  std::vector<double> output_mean;           ///< is added to them then; empty: 0
  bool residual = false;                     ///< the first inputs are added to the outputs at the end
};

/// The activation of this name. Throws std::invalid_argument if there is none.
Activation activation_of(std::string_view name);

/// Reads parameters from a file of `numpy.savez`: `weights_0` [outputs, inputs], `biases_0` [outputs], and so
/// on for each layer; `activation`, the name of an Activation; and, if present, `input_mean`, `input_scale`,
/// `output_mean`, `output_scale` and `residual`. Throws IoError that names the array and the rule it breaks.
MlpParameters load_mlp(const std::filesystem::path& npz_file);

namespace detail {

/// Parameters in the order in which the layers read them, with normalisation and padding in them.
class MlpNetwork {
 public:
  static constexpr int max_layers = 8;  ///< hidden layers and the output layer
  static constexpr int max_neurons = 64;
  static constexpr int block = 8;  ///< neurons that are computed together

  /// A network without hidden layers whose outputs are 0.
  MlpNetwork(int inputs, int outputs);
  /// Throws std::invalid_argument where the parameters do not fit together or to these sizes.
  MlpNetwork(const MlpParameters& parameters, int inputs, int outputs);

  /// Weights and biases in the order in which the layers read them.
  std::span<const float> weights() const noexcept {
    std::size_t count = 0;
    for (int i = 0; i < layers_; ++i)
      count += static_cast<std::size_t>((sizes_[i + 1] + block - 1) / block * block * (sizes_[i] + 1));
    return {weights_.get(), count};
  }

  /// The outputs of the samples of a warp of a GPU; false where they have to be computed one by one.
  template <class T, int Inputs, int Outputs>
  bool evaluate_warp(const T (&inputs)[Inputs], T (&outputs)[Outputs]) const {
    return gpu::dense_layers(weights_.get(), layers_, sizes_, inputs, outputs,
                             [this](T(&sum)[block]) { activate(sum); });
  }

  /// The outputs for `values` [inputs], which become those [outputs]; the array has room for `max_neurons`.
  template <class T>
  SLALOM_INLINE_CALLS void evaluate(T* values, T* other) const {
    const float* weight = weights_.get();
    for (int layer = 0; layer < layers_; ++layer) {
      const bool last = layer + 1 == layers_;
      const int inputs = sizes_[layer], blocks = (sizes_[layer + 1] + block - 1) / block;
      for (int b = 0; b < blocks; ++b, weight += block * (inputs + 1)) {
        T sum[block];
        weigh(weight, inputs, values, sum);
        if (!last) activate(sum);
        for (int k = 0; k < block; ++k) other[b * block + k] = sum[k];
      }
      std::swap(values, other);
    }
    if (layers_ % 2 == 1)  // the outputs are in the other array
      // The analyser does not see that the last layer has written all outputs.
      for (int i = 0; i < sizes_[layers_]; ++i)
        other[i] = values[i];  // NOLINT(clang-analyzer-core.uninitialized.Assign)
  }

 private:
  void store(const MlpParameters::Layer& layer, std::vector<float>& weights);

  /// The weighted sums of a block of neurons: biases, then the weights of each input.
  template <class T>
  SLALOM_INLINE_CALLS static void weigh(const float* weight, int inputs, const T* values, T (&sum)[block]) {
    for (int k = 0; k < block; ++k) sum[k] = T(weight[k]);
    for (int i = 0; i < inputs; ++i) {
      weight += block;
      const T value = values[i];
      for (int k = 0; k < block; ++k) sum[k] = sum[k] + T(weight[k]) * value;
    }
  }
  template <class T>
  SLALOM_INLINE_CALLS void activate(T (&sum)[block]) const {
    switch (activation_) {
      case Activation::tanh:
        for (T& s : sum) s = quick_tanh(s);
        break;
      case Activation::relu:
        for (T& s : sum) s = max(s, T(0.0f));
        break;
      case Activation::softplus:  // without overflow for large values
        for (T& s : sum) s = max(s, T(0.0f)) + quick_log1p(exp(-abs(s)));
        break;
      case Activation::silu:
        for (T& s : sum) s = s / (T(1.0f) + exp(-s));
        break;
    }
  }
  /// tanh(x), on packs within 2e-7. That of packs keeps the digits of small values, which sums of them lose.
  template <class T>
  SLALOM_INLINE_CALLS static T quick_tanh(const T& x) {
    if constexpr (is_pack<T>) {
      return T(1.0f) - T(2.0f) / (exp(x + x) + T(1.0f));
    } else if constexpr (gpu::computes<T>) {
      return gpu::tanh(x);
    } else {
      return tanh(x);
    }
  }

  /// log(1 + x) for x in [0, 1], on packs within 3e-7: x times a polynomial whose largest relative error is
  /// as small as its degree allows.
  template <class T>
  SLALOM_INLINE_CALLS static T quick_log1p(const T& x) {
    if constexpr (is_pack<T>) {
      T sum(-0.0085390976f);
      for (const float each :
           {0.044089243f, -0.10768118f, 0.17745205f, -0.24495450f, 0.33275478f, -0.49997405f, 0.99999981f})
        sum = sum * x + T(each);
      return sum * x;
    } else {
      return log1p(x);
    }
  }

  int layers_ = 1;
  int sizes_[max_layers + 1] = {};  ///< values that enter each layer, then the outputs
  Activation activation_ = Activation::tanh;
  std::shared_ptr<const float[]> weights_;
};

}  // namespace detail

/// A small neural network as a part of a problem: dense layers, for instance dynamics that were learned. The
/// weights are float32 and shared by all lanes and all copies.
///
///     struct Car {
///       slalom::Mlp<5, 3> slip{slalom::load_mlp("slip.npz")};
///       ...
///       const auto change = slip(x.speed, x.lateral_speed, x.yaw_rate, u[0], u[1]);   // change[0], [1], [2]
///
/// Inputs, outputs and hidden layers have at most 64 values, and there are at most 7 hidden layers.
template <int Inputs, int Outputs>
class Mlp {
  static_assert(Inputs >= 1 && Inputs <= detail::MlpNetwork::max_neurons,
                "slalom: an Mlp has 1 to 64 inputs");
  static_assert(Outputs >= 1 && Outputs <= detail::MlpNetwork::max_neurons,
                "slalom: an Mlp has 1 to 64 outputs");

 public:
  /// The outputs of a network.
  template <class T>
  struct Result {
    T value[Outputs];  ///< one for each output
    const T& operator[](int i) const { return value[i]; }
  };

  /// A network whose outputs are 0.
  Mlp() : network_(Inputs, Outputs) {}
  /// Throws std::invalid_argument where the parameters do not fit together or to these sizes.
  explicit Mlp(const MlpParameters& parameters)
      : network_(parameters, Inputs, Outputs), residual_(parameters.residual) {}

  /// The outputs for inputs of one scalar type: double, a pack, a dual number.
  template <class T, class... More>
  requires(1 + sizeof...(More) == Inputs) SLALOM_INLINE_CALLS Result<T>
  operator()(const T& first, const More&... more) const {
    const T inputs[Inputs] = {first, T(more)...};
    Result<T> result;
    bool evaluated = false;
    if constexpr (detail::gpu::computes<T>) evaluated = network_.evaluate_warp(inputs, result.value);
    if (!evaluated) {
      T values[detail::MlpNetwork::max_neurons], other[detail::MlpNetwork::max_neurons];
      for (int i = 0; i < Inputs; ++i) values[i] = inputs[i];
      network_.evaluate(values, other);
      for (int i = 0; i < Outputs; ++i) result.value[i] = values[i];
    }
    if constexpr (Outputs <= Inputs) {
      if (residual_)
        for (int i = 0; i < Outputs; ++i) result.value[i] = result.value[i] + inputs[i];
    }
    return result;
  }

  /// Weights and biases in the order in which the layers read them.
  std::span<const float> weights() const noexcept { return network_.weights(); }

 private:
  detail::MlpNetwork network_;
  bool residual_ = false;
};

}  // namespace slalom
