#pragma once

#include "solvers/kernels/kernels.hpp"
#include "solvers/kernels/particle_kernels.hpp"
#include "solvers/kernels/weight_kernels.hpp"

namespace slalom::detail {

/// The kernels for a scalar type, so that what is built from them is written once: float32 through the
/// instruction set in use, double for reference.
template <class Real>
struct KernelsOf;

template <>
struct KernelsOf<float> {
  static void add_linear(const Rows<float>& v, const float* coefficient, Range range, float* totals) {
    kernels().add_linear(v, coefficient, range, totals);
  }
  static void add_squared_distance(const Rows<float>& v, const float* centre, const float* weight,
                                   Range range, float* totals) {
    kernels().add_squared_distance(v, centre, weight, range, totals);
  }
  static void make_finite(Range range, float* costs) { kernels().make_finite(range, costs); }
  static float minimum(const float* costs, Range range) { return kernels().minimum(costs, range); }
  static WeightSums<float> exponential_weights(const float* totals, const float* costs, float least,
                                               float temperature, Range range, float* weights) {
    return kernels().exponential_weights(totals, costs, least, temperature, range, weights);
  }
  static void scale(float factor, Range range, float* values) { kernels().scale(factor, range, values); }
  static void weighted_sums(const Rows<float>& v, const float* weights, const float* centre, Range range,
                            float* sums) {
    kernels().weighted_sums(v, weights, centre, range, sums);
  }
  static void weighted_squares(const Rows<float>& v, const float* weights, const float* centre, Range range,
                               float* sums) {
    kernels().weighted_squares(v, weights, centre, range, sums);
  }
  static void particle_gradients(const ParticleGradients<float>& how, const Rows<float>& samples,
                                 const Rows<float>& theta, Range particles, float* exponents,
                                 const Rows<float>& gradient) {
    kernels().particle_gradients(how, samples, theta, particles, exponents, gradient);
  }
  static void stein_directions(const Rows<float>& x, const Rows<float>& gradient, int count, float bandwidth,
                               Range particles, const Rows<float>& phi) {
    kernels().stein_directions(x, gradient, count, bandwidth, particles, phi);
  }
  static WeightSums<float> split_weights(float falling, float growing, Range range, float* evaluated,
                                         float* rejected) {
    return kernels().split_weights(falling, growing, range, evaluated, rejected);
  }
  static void published_rejection(const Rows<float>& v, const RejectionRows<float>& densities, Range range,
                                  float* logarithms) {
    kernels().published_rejection(v, densities, range, logarithms);
  }
};

template <>
struct KernelsOf<double> {
  static void add_linear(const Rows<double>& v, const double* coefficient, Range range, double* totals) {
    body::add_linear<double>(v, coefficient, range, totals);
  }
  static void add_squared_distance(const Rows<double>& v, const double* centre, const double* weight,
                                   Range range, double* totals) {
    body::add_squared_distance<double>(v, centre, weight, range, totals);
  }
  static void make_finite(Range range, double* costs) { body::make_finite<double>(range, costs); }
  static double minimum(const double* costs, Range range) { return body::minimum<double>(costs, range); }
  static WeightSums<double> exponential_weights(const double* totals, const double* costs, double least,
                                                double temperature, Range range, double* weights) {
    return body::exponential_weights<double>(totals, costs, least, temperature, range, weights);
  }
  static void scale(double factor, Range range, double* values) {
    body::scale<double>(factor, range, values);
  }
  static void weighted_sums(const Rows<double>& v, const double* weights, const double* centre, Range range,
                            double* sums) {
    body::weighted_powers<false, double>(v, weights, centre, range, sums);
  }
  static void weighted_squares(const Rows<double>& v, const double* weights, const double* centre,
                               Range range, double* sums) {
    body::weighted_powers<true, double>(v, weights, centre, range, sums);
  }
  static void particle_gradients(const ParticleGradients<double>& how, const Rows<double>& samples,
                                 const Rows<double>& theta, Range particles, double* exponents,
                                 const Rows<double>& gradient) {
    body::particle_gradients<double>(how, samples, theta, particles, exponents, gradient);
  }
  static void stein_directions(const Rows<double>& x, const Rows<double>& gradient, int count,
                               double bandwidth, Range particles, const Rows<double>& phi) {
    body::stein_directions<double>(x, gradient, count, bandwidth, particles, phi);
  }
  static WeightSums<double> split_weights(double falling, double growing, Range range, double* evaluated,
                                          double* rejected) {
    return body::split_weights<double>(falling, growing, range, evaluated, rejected);
  }
  static void published_rejection(const Rows<double>& v, const RejectionRows<double>& densities, Range range,
                                  double* logarithms) {
    body::published_rejection<double>(v, densities, range, logarithms);
  }
};

}  // namespace slalom::detail
