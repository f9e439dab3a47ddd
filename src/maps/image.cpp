#include "slalom/maps/image.hpp"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
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

/// An interlaced image is decoded as a whole, with up to four bytes a pixel.
constexpr std::size_t max_interlaced_pixels = std::size_t{1} << 24;

struct Closer {
  void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
};
using File = std::unique_ptr<std::FILE, Closer>;

/// Data that libpng's handlers and the guarded functions below share. They may hold no object with a
/// destructor of their own, because libpng leaves them by longjmp.
struct Session {
  png_structp png = nullptr;
  png_infop info = nullptr;
  char message[128] = "";
  std::size_t width = 0, height = 0, channels = 0;
  int passes = 1;  ///< above 1 where the image is interlaced
  std::vector<std::uint8_t> bytes;
  std::vector<png_bytep> rows;
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* session = static_cast<Session*>(png_get_error_ptr(png));
  std::snprintf(session->message, sizeof session->message, "%s", message);
  std::longjmp(png_jmpbuf(png), 1);
}

void on_warning(png_structp, png_const_charp) {}

bool read_header(Session& session, std::FILE* file) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_init_io(session.png, file);
  png_set_user_limits(session.png, max_image_side, max_image_side);
  png_read_info(session.png, session.info);
  png_set_expand(session.png);    // palette to RGB, less than 8 bits to 8, transparency to alpha
  png_set_scale_16(session.png);  // 16 bits to 8, without gamma
  session.passes = png_set_interlace_handling(session.png);
  png_read_update_info(session.png, session.info);
  session.width = png_get_image_width(session.png, session.info);
  session.height = png_get_image_height(session.png, session.info);
  session.channels = png_get_channels(session.png, session.info);
  return true;
}

/// Reads the next row; an interlaced image, as a whole.
bool read_rows(Session& session) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_read_rows(session.png, session.rows.data(), nullptr, static_cast<png_uint_32>(session.rows.size()));
  return true;
}

bool read_interlaced(Session& session) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_read_image(session.png, session.rows.data());
  return true;
}

bool read_end(Session& session) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_read_end(session.png, nullptr);
  return true;
}

bool write_all(Session& session, std::FILE* file) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_init_io(session.png, file);
  png_set_IHDR(session.png, session.info, static_cast<png_uint_32>(session.width),
               static_cast<png_uint_32>(session.height), 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_rows(session.png, session.info, session.rows.data());
  png_write_png(session.png, session.info, PNG_TRANSFORM_IDENTITY, nullptr);
  return true;
}

/// Room for `rows` rows.
void point_rows(Session& session, std::size_t rows) {
  session.rows.resize(rows);
  for (std::size_t y = 0; y < rows; ++y) {
    session.rows[y] = &session.bytes[y * session.width * session.channels];
  }
}

/// Adds the pixels of the session's rows: the mean of their colours, and their opacity.
void append_pixels(const Session& session, GreyImage& image) {
  const std::size_t colours = session.channels >= 3 ? 3 : 1;
  for (std::size_t at = 0; at < session.bytes.size(); at += session.channels) {
    const std::uint8_t* pixel = &session.bytes[at];
    const unsigned sum = colours == 3 ? (pixel[0] + pixel[1] + pixel[2] + 1u) / 3u : pixel[0];
    image.grey.push_back(static_cast<std::uint8_t>(sum));
    if (session.channels > colours) image.opacity.push_back(pixel[colours]);
  }
}

/// All pixels, in memory of the size of the image that is returned and, unless it is interlaced, one row.
GreyImage read_pixels(Session& session, const std::filesystem::path& path) {
  GreyImage image{static_cast<int>(session.width), static_cast<int>(session.height), {}, {}};
  const bool interlaced = session.passes > 1;
  if (interlaced && session.width * session.height > max_interlaced_pixels)
    throw IoError(path.string(), 0,
                  "the PNG is interlaced and has more than " + std::to_string(max_interlaced_pixels) +
                      " pixels; save it without interlacing");
  const std::size_t rows = interlaced ? session.height : 1;
  session.bytes.resize(session.width * session.channels * rows);
  point_rows(session, rows);
  image.grey.reserve(session.width * session.height);
  if (session.channels == 2 || session.channels == 4) image.opacity.reserve(session.width * session.height);
  bool whole = true;
  for (std::size_t y = 0; whole && y < session.height; y += rows) {
    whole = interlaced ? read_interlaced(session) : read_rows(session);
    if (whole) append_pixels(session, image);
  }
  if (!whole || !read_end(session))
    throw IoError(path.string(), 0, std::string("the PNG is truncated or corrupt: ") + session.message);
  return image;
}

GreyImage read_png(const std::filesystem::path& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) throw cannot_open(path);
  Session session;
  session.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  if (!session.png) throw IoError(path.string(), 0, "libpng cannot be set up");
  const auto release = [](Session* s) { png_destroy_read_struct(&s->png, &s->info, nullptr); };
  const std::unique_ptr<Session, decltype(release)> guard(&session, release);
  session.info = png_create_info_struct(session.png);
  if (!session.info || !read_header(session, file.get())) {
    throw IoError(path.string(), 0, std::string("the PNG cannot be read: ") + session.message);
  }
  check_image_size(path, static_cast<std::int64_t>(session.width), static_cast<std::int64_t>(session.height));
  return read_pixels(session, path);
}

void write_png(const GreyImage& image, const std::filesystem::path& path) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) throw IoError(path.string(), 0, "the image cannot be opened for writing");
  Session session;
  session.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  if (!session.png) throw IoError(path.string(), 0, "libpng cannot be set up");
  const auto release = [](Session* s) { png_destroy_write_struct(&s->png, &s->info); };
  const std::unique_ptr<Session, decltype(release)> guard(&session, release);
  session.info = png_create_info_struct(session.png);
  session.width = image.width;
  session.height = image.height;
  session.channels = 1;
  session.bytes = image.grey;
  point_rows(session, session.height);
  if (!session.info || !write_all(session, file.get()) || std::fclose(file.release()) != 0) {
    throw IoError(path.string(), 0, std::string("the PNG cannot be written: ") + session.message);
  }
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
  write_png(image, path);
}

}  // namespace slalom::maps
