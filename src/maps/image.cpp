#include "slalom/maps/image.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::maps {
namespace {

/// Throws IoError unless both sides and their product are within the limits of image.hpp.
void check_image_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height) {
  if (width < 1 || height < 1 || width > max_image_side || height > max_image_side ||
      width * height > max_image_pixels) {
    throw IoError(path.string(), 0,
                  "the image has " + std::to_string(width) + " x " + std::to_string(height) +
                      " pixels; each side must be within 1 to " + std::to_string(max_image_side) +
                      ", all pixels at most " + std::to_string(max_image_pixels));
  }
}

/// Walks through the bytes of a PGM file: numbers separated by white space and comments.
class PgmReader {
 public:
  PgmReader(const std::filesystem::path& path, const std::string& bytes) : path_(path), bytes_(bytes) {}

  /// The next number, at most `largest`.
  std::int64_t number(const char* what, std::int64_t largest) {
    skip_blank();
    std::int64_t value = 0;
    const std::size_t first = position_;
    while (position_ < bytes_.size() && bytes_[position_] >= '0' && bytes_[position_] <= '9') {
      value = value * 10 + (bytes_[position_++] - '0');
      if (value > largest) fail(std::string(what) + " must be at most " + std::to_string(largest));
    }
    if (position_ == first)
      fail(std::string(what) + " is missing or not a number: the PGM is truncated or corrupt");
    return value;
  }

  /// The next value of one or two bytes, after skip_one().
  unsigned binary(int size) {
    unsigned value = 0;
    for (int i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes_[position_++]);
    return value;
  }

  void skip_one() { ++position_; }

  /// Whether nothing more follows; many programs end even binary pixels with a line end.
  bool at_end(bool text) {
    if (text) skip_blank();
    const std::string_view rest = std::string_view(bytes_).substr(std::min(position_, bytes_.size()));
    return rest.empty() || rest == "\n" || rest == "\r\n";
  }

  std::size_t left() const { return position_ < bytes_.size() ? bytes_.size() - position_ : 0; }
  [[noreturn]] void fail(const std::string& rule) const { throw IoError(path_.string(), 0, rule); }

 private:
  void skip_blank() {
    while (position_ < bytes_.size()) {
      const char c = bytes_[position_];
      if (c == '#') {
        while (position_ < bytes_.size() && bytes_[position_] != '\n') ++position_;
      } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
        ++position_;
      } else {
        return;
      }
    }
  }

  const std::filesystem::path& path_;
  const std::string& bytes_;
  std::size_t position_ = 2;  // behind the magic number
};

/// A pixel takes two bytes, or in text up to six.
constexpr std::uint64_t max_pgm_bytes = 6 * static_cast<std::uint64_t>(max_image_pixels) + (1 << 16);

GreyImage read_pgm(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, max_pgm_bytes);
  PgmReader reader(path, bytes);
  const std::int64_t width = reader.number("the width", max_image_side + 1);
  const std::int64_t height = reader.number("the height", max_image_side + 1);
  check_image_size(path, width, height);
  const std::int64_t largest = reader.number("the largest grey value", 65535);
  if (largest < 1) reader.fail("the largest grey value must be at least 1");

  const auto pixels = static_cast<std::size_t>(width * height);
  const bool text = bytes[1] == '2';
  const std::size_t size = largest > 255 ? 2 : 1;
  if (!text) reader.skip_one();
  // A text pixel takes at least a digit and a space, but for the last.
  if (reader.left() < (text ? 2 * pixels - 1 : size * pixels)) {
    reader.fail("the PGM is truncated: it must hold " + std::to_string(pixels) + " pixels");
  }
  GreyImage image{static_cast<int>(width), static_cast<int>(height), {}, {}};
  image.grey.resize(pixels);
  for (auto& grey : image.grey) {
    const std::int64_t value =
        text ? reader.number("a pixel", largest) : reader.binary(static_cast<int>(size));
    if (value > largest) reader.fail("a pixel must be at most " + std::to_string(largest));
    grey = static_cast<std::uint8_t>((value * 255 + largest / 2) / largest);
  }
  // A size other than that of the header would give a map with every row out of place.
  if (!reader.at_end(text)) {
    reader.fail("the PGM holds more than the " + std::to_string(width) + " x " + std::to_string(height) +
                " pixels of its header");
  }
  return image;
}

/// An image in libpng's simplified interface.
struct Png : png_image {
  Png() : png_image{} { version = PNG_IMAGE_VERSION; }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;
  ~Png() { png_image_free(this); }
};

GreyImage read_png(const std::filesystem::path& path) {
  Png png;
  if (!png_image_begin_read_from_file(&png, path.c_str()))
    throw IoError(path.string(), 0, std::string("the PNG cannot be read: ") + png.message);
  check_image_size(path, png.width, png.height);
  png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // 16 bits to 8, without gamma
  png.format &= PNG_FORMAT_FLAG_COLOR | PNG_FORMAT_FLAG_ALPHA;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(png));
  const std::size_t channels = PNG_IMAGE_SAMPLE_CHANNELS(png.format);
  const bool coloured = png.format & PNG_FORMAT_FLAG_COLOR, opacity = png.format & PNG_FORMAT_FLAG_ALPHA;
  if (!png_image_finish_read(&png, nullptr, bytes.data(), 0, nullptr))
    throw IoError(path.string(), 0, std::string("the PNG is truncated or corrupt: ") + png.message);
  GreyImage image{static_cast<int>(png.width), static_cast<int>(png.height), {}, {}};
  for (std::size_t at = 0; at < bytes.size(); at += channels) {
    const std::uint8_t* pixel = &bytes[at];
    const unsigned grey = coloured ? (pixel[0] + pixel[1] + pixel[2] + 1u) / 3u : pixel[0];
    image.grey.push_back(static_cast<std::uint8_t>(grey));
    if (opacity) image.opacity.push_back(pixel[channels - 1]);
  }
  return image;
}

}  // namespace

GreyImage load_image(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path))  // opening a pipe would wait for its other end
    throw IoError(path.string(), 0, "the image does not exist or cannot be read: it must be a regular file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw cannot_open(path);
  std::array<char, 2> magic{};
  stream.read(magic.data(), magic.size());
  if (magic[0] == 'P' && (magic[1] == '2' || magic[1] == '5')) return read_pgm(path);
  if (magic[0] == '\x89' && magic[1] == 'P') return read_png(path);
  throw IoError(path.string(), 0, "the image must be a PNG or a grey PGM (P2, P5)");
}

void save_png(const GreyImage& image, const std::filesystem::path& path) {
  check_image_size(path, image.width, image.height);
  if (image.grey.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
    throw std::invalid_argument("save_png: the image must have width x height pixels");
  }
  Png png;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_GRAY;
  if (!png_image_write_to_file(&png, path.c_str(), 0, image.grey.data(), 0, nullptr))
    throw IoError(path.string(), 0, std::string("the PNG cannot be written: ") + png.message);
}

}  // namespace slalom::maps
