#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace slalom::maps {

/// A grey image of 8 bits, row-major, row 0 at the top as in image files.
struct GreyImage {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<std::uint8_t> grey;  ///< height x width, 0 black, 255 white
  std::vector<std::uint8_t>
      opacity;  ///< height x width, 255 opaque; empty where the file has no transparency

  /// Grey value of a pixel.
  std::uint8_t at(int column, int row_from_top) const {
    return grey[static_cast<std::size_t>(row_from_top) * width + column];
  }
};

/// Most pixels along one side, and in all, of an image that is read or written.
inline constexpr int max_image_side = 32768;
inline constexpr std::int64_t max_image_pixels = std::int64_t{1} << 26;  ///< larger images are rejected

/// Reads a PNG (grey, palette, RGB, with or without alpha, 1 to 16 bits) or a PGM (P2, P5), told apart by
/// their first bytes. Colours are averaged, as map_server does. Throws IoError.
GreyImage load_image(const std::filesystem::path& path);

/// Writes the grey part as an 8 bit PNG. Throws IoError if the file cannot be written or the image has no or
/// too many pixels, and std::invalid_argument unless `grey` has width x height values.
void save_png(const GreyImage& image, const std::filesystem::path& path);

}  // namespace slalom::maps
