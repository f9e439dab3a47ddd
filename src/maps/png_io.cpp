#include "png_io.hpp"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <memory>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::maps::detail {
namespace {

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

}  // namespace

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

}  // namespace slalom::maps::detail
