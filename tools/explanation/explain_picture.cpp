#include "tools/explanation/explain_picture.hpp"
#include "tools/command_line/words.hpp"

#include <numbers>

namespace slalom::tools {
namespace {

constexpr Colour frame{0.78, 0.81, 0.86, 1}, disc_fill{0.36, 0.39, 0.45, 1},
    disc_shade{0.36, 0.39, 0.45, 0.13}, bad{0.80, 0.24, 0.20, 0.09}, bad_key{0.80, 0.24, 0.20, 0.45},
    ours{0.12, 0.42, 0.78, 1}, ours_light{0.12, 0.42, 0.78, 0.16}, optimum{0.90, 0.58, 0.10, 1},
    optimum_light{0.96, 0.72, 0.26, 0.30}, guide = guide_colour, good_verdict{0.05, 0.48, 0.30, 1},
                                           bad_verdict{0.75, 0.16, 0.14, 1};
constexpr double margin = 22, header = 112, caption = 46, space_width = 330, space_height = 250, gap = 8,
                 density_width = 104, axis_left = 34, axis_below = 34, reach = 1.5;
constexpr double cell_width = axis_left + space_width + gap + density_width,
                 cell_height = caption + space_height + axis_below;
constexpr int drawn_samples = 100;

/// The plots of a method.
struct Cell {
  const Explanation& e;
  double left, top;  ///< corner of the plot in space, pixels

  double length() const { return e.point.speed * e.point.dt * static_cast<double>(e.plan.size() - 1); }
  double x(double metres) const { return left + space_width * metres / length(); }
  double y(double metres) const { return top + space_height * (reach - metres) / (2 * reach); }
  double density_left() const { return left + space_width + gap; }
  Pen::Points points(const Way& way) const {
    Pen::Points result;
    for (std::size_t k = 0; k < way.size(); ++k)
      result.emplace_back(x(e.point.speed * e.point.dt * static_cast<double>(k)), y(way[k]));
    return result;
  }
};

/// The samples that collide first, then the others from high to low cost; the larger the weight, the bolder.
void draw_samples(Pen& pen, const Cell& cell) {
  std::vector<const ExplainedSample*> drawn;
  const auto& all = cell.e.samples;
  double least = 1e300, heaviest = 0;
  for (const auto& s : all) {
    if (!s.collided) least = std::min(least, s.cost);
    heaviest = std::max(heaviest, s.weight);
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(drawn_samples, all.size()); ++i) drawn.push_back(&all[i]);
  std::sort(drawn.begin(), drawn.end(), [](const auto* a, const auto* b) {
    return a->collided != b->collided ? a->collided : a->cost > b->cost;
  });
  for (const ExplainedSample* s : drawn) {
    if (s->collided) {
      pen.path(cell.points(s->way), bad, 1);
    } else {
      const double share = heaviest > 0 ? s->weight / heaviest : 0;
      pen.path(cell.points(s->way), cost_colour((s->cost - least) / 4, 0.34 + 0.5 * share),
               0.8 + 1.6 * share);
    }
  }
}

void draw_distribution(Pen& pen, const Cell& cell) {
  Way low, high;
  for (std::size_t k = 0; k < cell.e.mean.size(); ++k) {
    low.push_back(cell.e.mean[k] - 2 * cell.e.deviation[k]);
    high.push_back(cell.e.mean[k] + 2 * cell.e.deviation[k]);
  }
  Pen::Points outline = cell.points(high), back = cell.points(low);
  outline.insert(outline.end(), back.rbegin(), back.rend());
  pen.area(outline, ours_light);
  for (const Way& edge : {low, high}) pen.path(cell.points(edge), {ours.red, ours.green, ours.blue, 0.55}, 1);
}

/// Every guide's way after each step, pale where it began. The guides that did not become the plan's are
/// faint.
void draw_guides(Pen& pen, const Cell& cell) {
  for (std::size_t g = 0; g < cell.e.guides.size(); ++g) {
    const auto& steps = cell.e.guides[g];
    const bool best = static_cast<int>(g) == cell.e.best_guide;
    const double strength = best ? 1 : 0.3;
    const std::size_t count = steps.size();
    for (std::size_t l = 1; l <= count; ++l) {
      const double age = static_cast<double>(l) / static_cast<double>(count);
      pen.path(cell.points(steps[l - 1]),
               {guide.red, guide.green, guide.blue, strength * (l == count ? 1 : 0.15 + 0.4 * age * age)},
               l == count && best ? 2 : 1);
    }
  }
}

void draw_space(Pen& pen, const Cell& cell) {
  const auto& point = cell.e.point;
  pen.box(cell.left, cell.top, space_width, space_height, white, {}, 0, 0);
  pen.clip(cell.left, cell.top, space_width, space_height);
  for (const double at : {-1.0, 0.0, 1.0})
    pen.line(cell.left, cell.y(at), cell.left + space_width, cell.y(at), rule, 1);
  draw_samples(pen, cell);
  draw_distribution(pen, cell);
  Pen::Points rim;
  for (int i = 0; i < 90; ++i) {
    const double angle = 2 * std::numbers::pi * i / 90;
    rim.emplace_back(cell.x(point.disc_x + point.disc_radius * std::cos(angle)),
                     cell.y(point.disc_y + point.disc_radius * std::sin(angle)));
  }
  pen.area(rim, disc_fill);
  draw_guides(pen, cell);
  pen.path(cell.points(cell.e.plan), white, 5.5);
  pen.path(cell.points(cell.e.plan), ink, 3);
  pen.disc(cell.x(0), cell.y(0), 5, ink);
  pen.unclip();
  pen.box(cell.left, cell.top, space_width, space_height, {0, 0, 0, 0}, frame, 1, 0);
  for (int i = 0; i <= static_cast<int>(cell.length() + 1e-9); ++i)
    pen.text(cell.x(i), cell.top + space_height + 15, 11, formatted("%d", i), faint_ink, 0.5);
  for (const double at : {-1.0, 0.0, 1.0})
    pen.text(cell.left - 7, cell.y(at) + 4, 11, formatted("%g", at), faint_ink, 1);
  pen.text(cell.left + space_width / 2, cell.top + space_height + 29, 11, "ahead, m", faint_ink, 0.5);
}

/// Densities of the place beside the disc, along the same axis as in space.
void draw_density(Pen& pen, const Cell& cell) {
  const Explanation& e = cell.e;
  const double left = cell.density_left(), mean = e.mean[static_cast<std::size_t>(e.beside)],
               deviation = std::max(1e-3, e.deviation[static_cast<std::size_t>(e.beside)]);
  const auto gaussian = [&](double place) {
    const double z = (place - mean) / deviation;
    return std::exp(-0.5 * z * z) / (deviation * 2.5066282746310002);
  };
  double highest = gaussian(mean);
  for (const double d : e.density) highest = std::max(highest, d);
  // Two densities are compared by shape, so both share a scale, cut where one is a needle.
  highest = std::min(highest, 3.0 * *std::max_element(e.density.begin(), e.density.end()));
  const auto across = [&](double density) {
    return left + std::min(density / highest, 1.0) * (density_width - 6);
  };
  pen.box(left, cell.top, density_width, space_height, white, {}, 0, 0);
  pen.clip(left, cell.top, density_width, space_height);
  const double disc_top = cell.y(e.point.disc_y + e.point.disc_radius);
  pen.box(left, disc_top, density_width, cell.y(e.point.disc_y - e.point.disc_radius) - disc_top, disc_shade,
          {}, 0, 0);
  const auto curve = [&](auto value) {
    Pen::Points points;
    for (int i = 0; i <= 300; ++i) {
      const double place = -reach + 2 * reach * i / 300;
      points.emplace_back(across(value(place)), cell.y(place));
    }
    return points;
  };
  const auto closed = [&](Pen::Points points) {
    points.emplace_back(left, cell.y(reach));
    points.insert(points.begin(), {left, cell.y(-reach)});
    return points;
  };
  const auto best = [&](double place) {
    const double at = (place - e.places.front()) / (e.places[1] - e.places[0]);
    const auto i = static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(e.places.size() - 2)));
    return e.density[i] + (at - static_cast<double>(i)) * (e.density[i + 1] - e.density[i]);
  };
  pen.area(closed(curve(best)), optimum_light);
  pen.path(curve(best), optimum, 1.6);
  pen.area(closed(curve(gaussian)), ours_light);
  pen.path(curve(gaussian), ours, 2);
  const double plan = cell.y(e.plan[static_cast<std::size_t>(e.beside)]);
  pen.line(left, plan, left + density_width, plan, ink, 2);
  pen.unclip();
  pen.box(left, cell.top, density_width, space_height, {0, 0, 0, 0}, frame, 1, 0);
  pen.text(left + density_width / 2, cell.top + space_height + 15, 11, "density", faint_ink, 0.5);
  pen.text(left + density_width / 2, cell.top + space_height + 29, 11, "beside the disc", faint_ink, 0.5);
}

void draw_caption(Pen& pen, const Cell& cell) {
  const Explanation& e = cell.e;
  const double place = e.plan[static_cast<std::size_t>(e.beside)];
  pen.text(cell.left, cell.top - 26, 16, e.method, ink, 0, true);
  pen.text(cell.left + space_width + gap + density_width, cell.top - 26, 12, e.about, faint_ink, 1);
  const std::string verdict = e.plan_collides ? "The plan hits the disc."
                              : place > 0
                                  ? "The plan passes on the left, " + formatted("%.2f m", place) + "."
                                  : "The plan passes on the right, " + formatted("%.2f m", -place) + ".";
  pen.text(cell.left, cell.top - 8, 12.5, verdict, e.plan_collides ? bad_verdict : good_verdict, 0, true);
  pen.text(cell.left + space_width + gap + density_width, cell.top - 8, 12,
           formatted("%.0f of ", e.effective_samples) +
               formatted("%.0f samples count", static_cast<double>(e.samples.size())),
           faint_ink, 1);
}

/// The key of lines and colours, with that of guides or without.
void draw_key(Pen& pen, bool guides) {
  double x = margin, y = 56;
  const auto entry = [&](const std::string& words, double symbol_width, auto symbol) {
    const double wide = symbol_width + 6 + pen.text_width(words, 12);
    if (x > margin && x + wide > margin + cell_width) {
      x = margin;
      y += 20;
    }
    symbol();
    pen.text(x + symbol_width + 6, y + 4, 12, words, ink);
    x += wide + 20;
  };
  const auto box = [&](Colour fill, Colour rim) { pen.box(x, y - 6, 22, 12, fill, rim, 1.2); };
  entry("plan", 22, [&] { pen.line(x, y, x + 22, y, ink, 3); });
  entry("samples, low to high cost; bold: large weight", 44, [&] {
    for (int i = 0; i < 44; ++i) pen.line(x + i, y, x + i + 1.2, y, cost_colour(i / 44.0, 1), 5);
  });
  entry("samples that hit", 22, [&] { pen.line(x, y, x + 22, y, bad_key, 2); });
  if (guides) entry("guide, pale where it came from", 22, [&] { pen.line(x, y, x + 22, y, guide, 2); });
  entry("resulting distribution, 2 deviations", 22, [&] { box(ours_light, ours); });
  entry("optimal distribution q*", 22, [&] { box(optimum_light, optimum); });
}

}  // namespace

void draw_title(Pen& pen, double left, double width, const std::string& title) {
  pen.text(left, 30, std::min(19.0, 19 * width / pen.text_width(title, 19, true)), title, ink, 0, true);
}

Drawing draw_explanation(const Explanation& explanation, const std::string& title) {
  const auto draw = [explanation, title](Pen& pen) {
    draw_title(pen, margin, cell_width, title);
    draw_key(pen, !explanation.guides.empty());
    const Cell cell{explanation, margin + axis_left, header + caption};
    draw_space(pen, cell);
    draw_density(pen, cell);
    draw_caption(pen, cell);
  };
  return {2 * margin + cell_width, header + cell_height + margin * 0.6, draw};
}

}  // namespace slalom::tools
