#include "slalom/maps/image.hpp"

#include <png.h>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::maps::image_test {
namespace {

using slalom::testing::TemporaryFolder;

/// Two pixels wide, one high.
class Image : public TemporaryFolder {
 protected:
  /// Writes pixels of the given PNG layout with libpng itself.
  std::filesystem::path write_png(int colour_type, int bits, std::vector<std::uint8_t> row,
                                  bool palette = false) {
    const auto path = folder_ / "image.png";
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, 2, 1, bits, colour_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    const png_color colours[] = {{0, 0, 0}, {30, 60, 90}, {255, 255, 255}};
    const png_byte opacity[] = {255, 0};
    if (palette) {
      png_set_PLTE(png, info, colours, 3);
      png_set_tRNS(png, info, opacity, 2, nullptr);
    }
    png_bytep rows[] = {row.data()};
    png_set_rows(png, info, rows);
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&png, &info);
    EXPECT_EQ(std::fclose(file), 0);
    return path;
  }

  using Bytes = std::vector<std::uint8_t>;
};

TEST_F(Image, ColoursAreAveraged) {
  const GreyImage image = load_image(write_png(PNG_COLOR_TYPE_RGB, 8, {30, 60, 90, 255, 255, 255}));
  EXPECT_EQ(image.grey, (Bytes{60, 255}));
  EXPECT_TRUE(image.opacity.empty());
}

TEST_F(Image, IgnoresTransparency) {
  const GreyImage colour = load_image(write_png(PNG_COLOR_TYPE_RGB_ALPHA, 8, {0, 0, 0, 255, 90, 90, 90, 7}));
  EXPECT_EQ(colour.grey, (Bytes{0, 90}));
  EXPECT_EQ(colour.opacity, (Bytes{255, 7}));
  const GreyImage grey = load_image(write_png(PNG_COLOR_TYPE_GRAY_ALPHA, 8, {10, 20, 30, 40}));
  EXPECT_EQ(grey.grey, (Bytes{10, 30}));
  EXPECT_EQ(grey.opacity, (Bytes{20, 40}));
}

TEST_F(Image, SixteenBitsAndOneBit) {
  EXPECT_EQ(load_image(write_png(PNG_COLOR_TYPE_GRAY, 16, {0x80, 0x80, 0xff, 0xff})).grey,
            (Bytes{0x80, 255}));
  EXPECT_EQ(load_image(write_png(PNG_COLOR_TYPE_GRAY, 1, {0x40})).grey, (Bytes{0, 255}));
}

TEST_F(Image, Palettes) {
  const GreyImage image = load_image(write_png(PNG_COLOR_TYPE_PALETTE, 8, {1, 2}, true));
  EXPECT_EQ(image.grey, (Bytes{60, 255}));
  EXPECT_EQ(image.opacity, (Bytes{0, 255}));
}

TEST_F(Image, RejectsImagesThatCannotBeSaved) {
  EXPECT_THROW(save_png({2, 2, Bytes(3), {}}, folder_ / "image.png"), std::invalid_argument);
  EXPECT_THROW(save_png({0, 0, {}, {}}, folder_ / "image.png"), IoError);
  EXPECT_THROW(save_png({1, 1, Bytes(1), {}}, folder_ / "absent" / "image.png"), IoError);
}

}  // namespace
}  // namespace slalom::maps::image_test
