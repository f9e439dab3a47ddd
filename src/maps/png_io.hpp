#pragma once

#include "slalom/maps/image.hpp"

namespace slalom::maps::detail {

/// Throws IoError unless both sides and their product are within the limits of image.hpp.
void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height);

GreyImage read_png(const std::filesystem::path& path);
void write_png(const GreyImage& image, const std::filesystem::path& path);

}  // namespace slalom::maps::detail
