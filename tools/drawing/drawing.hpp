#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "tools/drawing/pen.hpp"

namespace slalom::tools {

/// A drawing that looks the same as SVG and as PNG.
struct Drawing {
  double width = 0, height = 0;
  std::function<void(Pen&)> draw;
};

/// The drawing as an SVG document. Throws IoError, and as `require_font_files` does.
std::string to_svg(const Drawing& drawing);
/// Writes it with `scale` pixels for one. Throws IoError, and as `require_font_files` does.
void save_png(const Drawing& drawing, const std::filesystem::path& file, double scale = 2);

}  // namespace slalom::tools
