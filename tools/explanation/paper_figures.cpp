
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/mppi_options.hpp"
#include "slalom/solvers/svg_mppi_options.hpp"
#include "tools/command_line/words.hpp"
#include "tools/drawing/axis.hpp"
#include "tools/explanation/explain_picture.hpp"

namespace slalom::tools {
namespace {

constexpr Colour optimum{0.90, 0.58, 0.10, 1}, forward{0.75, 0.16, 0.14, 1}, reverse{0.05, 0.48, 0.30, 1},
    guide{0.55, 0.16, 0.66, 1}, frame{0.78, 0.81, 0.86, 1};
constexpr double plot_width = 420, plot_height = 250, left = 46, top = 110;

struct Curve {
  std::string name;
  Colour colour;
  Pen::Points points;  ///< values of both axes
  bool dots = false;
};

/// A plot of densities with its key above it.
Drawing draw_plot(const std::string& title, const std::string& label, const std::vector<Curve>& curves) {
  const auto draw = [=](Pen& pen) {
    double low = 1e300, high = -1e300, highest = 0;
    for (const Curve& curve : curves)
      for (const auto& [x, y] : curve.points) {
        low = std::min(low, x);
        high = std::max(high, x);
        highest = std::max(highest, y);
      }
    const Axis across = linear_axis(low, high, left, left + plot_width, 6, true);
    const Axis up = linear_axis(0, 1.05 * highest, top + plot_height, top, 4, true);
    draw_title(pen, left, plot_width, title);
    double y = 54;
    for (const Curve& curve : curves) {
      if (curve.dots) {
        pen.disc(left + 11, y - 4, 4, curve.colour);
      } else {
        pen.line(left, y - 4, left + 22, y - 4, curve.colour, 3);
      }
      pen.text(left + 30, y, 12, curve.name, ink);
      y += 18;
    }
    for (const double at : across.ticks) {
      pen.line(across(at), top, across(at), top + plot_height, rule, 1);
      pen.text(across(at), top + plot_height + 16, 11, short_number(at), faint_ink, 0.5);
    }
    for (const Curve& curve : curves) {
      Pen::Points points;
      for (const auto& [px, py] : curve.points) points.emplace_back(across(px), up(py));
      if (!curve.dots) pen.path(points, curve.colour, 2.2);
      for (const auto& [px, py] : curve.dots ? points : Pen::Points{}) pen.disc(px, py, 4, curve.colour);
    }
    pen.box(left, top, plot_width, plot_height, {0, 0, 0, 0}, frame, 1, 0);
    pen.text(left + plot_width / 2, top + plot_height + 34, 12, label, faint_ink, 0.5);
    pen.text(left, top - 6, 11, "density", faint_ink);
  };
  return {left + plot_width + 24, top + plot_height + 44, draw};
}

struct Gaussian {
  double mean = 0, deviation = 1;
  double operator()(double x) const {
    const double z = (x - mean) / deviation;
    return std::exp(-0.5 * z * z) / (deviation * 2.5066282746310002);
  }
};

/// KL(Q || Q*) over the places of an explanation.
double reverse_divergence(const Gaussian& q, const Explanation& e) {
  const double step = e.places[1] - e.places[0];
  double divergence = 0;
  for (std::size_t i = 0; i < e.places.size(); ++i) {
    const double density = q(e.places[i]);
    if (density > 1e-12) divergence += step * density * std::log(density / std::max(e.density[i], 1e-9));
  }
  return divergence;
}

Pen::Points curve_of(const std::vector<double>& places, const std::function<double(double)>& density) {
  Pen::Points points;
  for (const double place : places) points.emplace_back(place, density(place));
  return points;
}

/// The Gaussians of least forward and of least reverse divergence, for the place beside the disc.
Drawing asymmetry(const Explanation& e) {
  Gaussian covers, seeks;
  double weight = 0, second = 0, least = 1e300;
  covers.mean = 0;
  for (std::size_t i = 0; i < e.places.size(); ++i) {
    weight += e.density[i];
    covers.mean += e.density[i] * e.places[i];
    second += e.density[i] * e.places[i] * e.places[i];
  }
  covers.mean /= weight;
  covers.deviation = std::sqrt(second / weight - covers.mean * covers.mean);
  for (int m = -100; m <= 100; ++m)
    for (int d = 2; d <= 100; ++d) {
      const Gaussian q{0.01 * m, 0.01 * d};
      const double divergence = reverse_divergence(q, e);
      if (divergence >= least) continue;
      least = divergence;
      seeks = q;
    }
  Pen::Points best;
  for (std::size_t i = 0; i < e.places.size(); ++i) best.emplace_back(e.places[i], e.density[i]);
  return draw_plot("Fig. 3: forward KL covers both modes, reverse KL seeks one", "place beside the disc, m",
                   {{"optimal distribution q*", optimum, best},
                    {"least KL(Q* || Q), forward", forward, curve_of(e.places, covers)},
                    {"least KL(Q || Q*), reverse", reverse, curve_of(e.places, seeks)}});
}

/// The input of the best guide at the step at which it moved most, after each of its own steps, and q* there,
/// with the Gaussian that equation (13) fits.
Drawing fitted_gaussian(const Explanation& e) {
  const auto inputs_of = [&](const Way& way) {
    std::vector<Input<double, 1>> inputs;
    for (std::size_t k = 0; k + 1 < way.size(); ++k) inputs.push_back({{(way[k + 1] - way[k]) / e.point.dt}});
    return inputs;
  };
  const auto cost = [&](const Way& way) {
    const auto inputs = inputs_of(way);
    return predict(e.point, problems::PassingPoint::State<double>{0, 0}, inputs.data(),
                   static_cast<int>(inputs.size()), nullptr)
        .value;
  };
  const auto path = *std::min_element(e.guides.begin(), e.guides.end(), [&](const auto& a, const auto& b) {
    return cost(a.back()) < cost(b.back());
  });
  const auto first = inputs_of(path.front()), last = inputs_of(path.back());
  const auto variance = [&](std::size_t k) {
    return (e.deviation[k + 1] * e.deviation[k + 1] - e.deviation[k] * e.deviation[k]) /
           (e.point.dt * e.point.dt);
  };
  std::size_t step = 0;
  double moved = -1;
  for (std::size_t k = 0; k < first.size(); ++k) {
    if (variance(k) > 0.99) continue;  // undetermined: the largest variance, 1
    if (std::abs(last[k][0] - first[k][0]) <= moved) continue;
    moved = std::abs(last[k][0] - first[k][0]);
    step = k;
  }
  std::vector<double> a, log_b;
  for (const Way& way : path) {
    const auto inputs = inputs_of(way);
    double log_q = -cost(way);
    for (std::size_t k = 0; k < inputs.size(); ++k) log_q -= 0.5 * std::pow(inputs[k][0] - last[k][0], 2);
    a.push_back(inputs[step][0]);
    log_b.push_back(log_q);
  }
  // With the variance of the solver, the other two coefficients of the parabola are a line's, by least
  // squares.
  const double highest = *std::max_element(log_b.begin(), log_b.end()), z2 = -0.5 / variance(step);
  double s0 = 0, s1 = 0, s2 = 0, t0 = 0, t1 = 0;
  Pen::Points points;
  for (std::size_t l = 0; l < a.size(); ++l) {
    const double b = std::exp(log_b[l] - highest), rest = std::log(b) - z2 * a[l] * a[l];
    points.emplace_back(a[l], b);
    s0 += b * b;
    s1 += b * b * a[l];
    s2 += b * b * a[l] * a[l];
    t0 += b * b * rest;
    t1 += b * b * a[l] * rest;
  }
  const double z1 = (s0 * t1 - s1 * t0) / (s0 * s2 - s1 * s1), z0 = (t0 - z1 * s1) / s0;
  std::vector<double> places;
  for (int i = 0; i <= 200; ++i) places.push_back(-2.5 + 0.025 * i);
  return draw_plot("(c) The covariance of one input, equation 13",
                   "input " + std::to_string(step) + " of the horizon, m/s",
                   {{"q* along the best guide's path", guide, points, true},
                    {"the fitted Gaussian", reverse,
                     curve_of(places, [&](double u) { return std::exp(z0 + z1 * u + z2 * u * u); })}});
}

/// The first drawing with the second at its right.
Drawing beside(const Drawing& a, const Drawing& b) {
  Drawing both{a.width + b.width, std::max(a.height, b.height), {}};
  both.draw = [a, b](Pen& pen) {
    a.draw(pen);
    pen.shift(a.width, 0);
    b.draw(pen);
  };
  return both;
}

/// The paper's closed form, with one batch of white noise, and guides that do not restart.
SvgMppiOptions closed_form() {
  SvgMppiOptions o{.batches = 1};
  o.guides.count = 4;
  o.guides.iterations = 10;
  o.guides.step = 0.125;
  o.guides.variance = o.guides.restart_variance = o.variance_max = 1;
  o.guides.gradient_samples = 25;
  o.guides.gradient_variance = 0.25;
  o.guides.gradient_temperature = 1;
  o.guides.restart = false;
  o.variance_min = 0.01;
  o.noise = {};
  return o;
}

}  // namespace

Drawing draw_paper_figure(int number, std::uint64_t seed) {
  if (number == 4) {
    const Explanation e = explain(closed_form(), "guides find a mode, MPPI solves near it", seed);
    return beside(draw_explanation(e, "Fig. 4: (a) guides, (b) the best of them, (d) MPPI near it"),
                  fitted_gaussian(e));
  }
  const Explanation e = explain(MppiOptions{.control_cost_discount = 0}, "forward KL, in closed form", seed);
  return number == 3 ? asymmetry(e) : draw_explanation(e, "Fig. 1: the mean of both ways hits the disc");
}

}  // namespace slalom::tools
