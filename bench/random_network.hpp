#pragma once

#include <random>

#include "bench/problems.hpp"

namespace slalom::bench {

/// A network with two hidden layers of 32 neurons and random weights, always the same.
inline Mlp<5, 3> random_network(Activation activation = Activation::tanh) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.2);
  MlpParameters p{.activation = activation, .residual = true};
  int entering = 5;
  for (const int neurons : {32, 32, 3}) {
    MlpParameters::Layer layer{entering, neurons, {}, {}};
    for (int i = 0; i < entering * neurons; ++i) layer.weights.push_back(normal(random));
    for (int i = 0; i < neurons; ++i) layer.biases.push_back(normal(random));
    p.layers.push_back(layer);
    entering = neurons;
  }
  return Mlp<5, 3>(p);
}

}  // namespace slalom::bench
