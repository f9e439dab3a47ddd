#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

/// SVG-MPPI as Honda et al. print it (ICRA 2024), in plain loops, with their symbols and, in brackets, their
/// equation numbers, except for the square root of (13). Tests compare the solver with it.
namespace slalom::reference {

/// A control sequence, or one value for each of its entries. Entry tau * m + i is input i of step tau.
using Sequence = std::vector<double>;

/// The cost S(V) of a control sequence.
using SequenceCost = std::function<double(const Sequence&)>;
/// A standard normal value for entry r of sample i around guide k in iteration l. k = -1: a sample of MPPI.
using Normal = std::function<double(int l, int k, int i, int r)>;

struct SvgMppi {
  int K = 256;                          ///< samples
  int L = 10;                           ///< iterations of the guides
  int N = 100;                          ///< samples for a gradient
  double lambda = 1;                    ///< temperature
  double epsilon = 0.1;                 ///< step size of the guides, input^2
  double Sigma_g = 0.25;                ///< variance of the samples for a gradient, input^2
  double Sigma_0 = 1;                   ///< variance in the weights of the guides, input^2
  double Sigma_min = 0, Sigma_max = 1;  ///< limits of the adapted variances, input^2

  std::vector<Sequence> V_g{};  ///< guide particles V_k^g
  Sequence U_tilde{}, U_hat{};  ///< nominal sequence, previous solution
  Sequence Sigma{};             ///< adapted variances

  /// One control cycle. Replaces U_hat by the solution U*.
  void solve(const SequenceCost& S, const Normal& z) {
    const int rows = static_cast<int>(U_hat.size());
    std::vector<std::vector<Sequence>> path(V_g.size());
    for (int l = 0; l < L; ++l) {
      for (int k = 0; k < static_cast<int>(V_g.size()); ++k) {
        Sequence& V = V_g[k];
        std::vector<Sequence> v(N, V);
        for (int i = 0; i < N; ++i)
          for (int r = 0; r < rows; ++r) v[i][r] += std::sqrt(Sigma_g) * z(l, k, i, r);
        const std::vector<double> w = weights(v, S, Sequence(rows, Sigma_0));
        for (int r = 0; r < rows; ++r) {
          double gradient = 0;  // of -D_KL(Q || Q*) (11)
          for (int i = 0; i < N; ++i) gradient += w[i] * (v[i][r] - V[r]) / Sigma_g;
          V[r] += epsilon * gradient;  // (9)
        }
        path[k].push_back(V);
      }
    }
    const auto best = std::ranges::min_element(V_g, {}, S);
    U_tilde = *best;                                 // (12)
    Sigma = variances(path[best - V_g.begin()], S);  // (13)
    std::vector<Sequence> V(K, U_hat);
    for (int k = 0; k < K; ++k)
      for (int r = 0; r < rows; ++r) V[k][r] += std::sqrt(Sigma[r]) * z(0, -1, k, r);
    const std::vector<double> w = weights(V, S, Sigma);
    U_hat.assign(rows, 0);
    for (int k = 0; k < K; ++k)
      for (int r = 0; r < rows; ++r) U_hat[r] += w[k] * V[k][r];  // (7)
  }

  /// Returns the weights w(V) of samples (8). Their sum is 1.
  std::vector<double> weights(const std::vector<Sequence>& V, const SequenceCost& S,
                              const Sequence& variance) const {
    std::vector<double> log_w;
    for (const Sequence& v : V) {
      log_w.push_back(-S(v) / lambda);
      for (std::size_t r = 0; r < v.size(); ++r) log_w.back() -= (U_hat[r] - U_tilde[r]) / variance[r] * v[r];
    }
    return normalised(log_w);
  }

  /// Returns exp(log_w), scaled so that the sum is 1.
  static std::vector<double> normalised(std::vector<double> log_w) {
    const double largest = *std::max_element(log_w.begin(), log_w.end());
    double eta = 0;
    for (double& value : log_w) eta += value = std::exp(value - largest);
    for (double& value : log_w) value /= eta;
    return log_w;
  }

  /// The variances of Gaussians fitted to the path of the best guide (13): a are its inputs, b is q* there.
  Sequence variances(const std::vector<Sequence>& path, const SequenceCost& S) const {
    std::vector<double> q;  // q* of each point of the path (5)
    for (const Sequence& V : path) {
      q.push_back(-S(V) / lambda);
      for (std::size_t r = 0; r < V.size(); ++r) q.back() -= 0.5 * std::pow(V[r] - U_tilde[r], 2) / Sigma_0;
    }
    const std::vector<double> b = normalised(q);
    Sequence fitted;
    for (std::size_t r = 0; r < U_tilde.size(); ++r) {
      std::vector<double> a;
      for (const Sequence& V : path) a.push_back(V[r] - U_tilde[r]);
      fitted.push_back(std::clamp(variance(a, b), Sigma_min, Sigma_max));
    }
    return fitted;
  }

  /// Fits the parabola z0 + z1 a + z2 a^2 to ln b with weights b^2 (Guo 2011). Returns -1 / (2 z2), or
  /// infinity if the parabola is convex. Densities below 1e-10 count as 1e-10.
  static double variance(const std::vector<double>& a, const std::vector<double>& b) {
    double s[5] = {}, t[3] = {};  // sums of b^2 a^n and of b^2 a^n ln b
    for (std::size_t j = 0; j < a.size(); ++j) {
      const double y = std::max(b[j], 1e-10);
      for (int n = 0; n < 5; ++n) s[n] += y * y * std::pow(a[j], n);
      for (int n = 0; n < 3; ++n) t[n] += y * y * std::pow(a[j], n) * std::log(y);
    }
    const auto determinant = [&](const double* c) {  // of the normal equations, with c as the last column
      return s[0] * (s[2] * c[2] - s[3] * c[1]) - s[1] * (s[1] * c[2] - s[3] * c[0]) +
             s[2] * (s[1] * c[1] - s[2] * c[0]);
    };
    const double z2 = determinant(t) / determinant(s + 2);
    return z2 < 0 ? -0.5 / z2 : INFINITY;
  }
};

}  // namespace slalom::reference
