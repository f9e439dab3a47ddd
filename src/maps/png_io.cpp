#include "png_io.hpp"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <memory>

#include "slalom/core/error.hpp"

namespace slalom::maps::detail {
namespace {

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

/// What libpng's handlers and the guarded functions below share. They may hold no object with a destructor of
/// their own, because libpng leaves them by longjmp.
struct Session {
  png_structp png = nullptr;
  png_infop info = nullptr;
  char message[128] = "";
  std::size_t width = 0, height = 0, channels = 0;
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
  png_set_interlace_handling(session.png);
  png_read_update_info(session.png, session.info);
  session.width = png_get_image_width(session.png, session.info);
  session.height = png_get_image_height(session.png, session.info);
  session.channels = png_get_channels(session.png, session.info);
  return true;
}

bool read_rows(Session& session) {
  if (setjmp(png_jmpbuf(session.png))) return false;
  png_read_image(session.png, session.rows.data());
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

void point_rows(Session& session) {
  session.rows.resize(session.height);
  for (std::size_t y = 0; y < session.height; ++y) {
    session.rows[y] = &session.bytes[y * session.width * session.channels];
  }
}

GreyImage average_channels(const Session& session) {
  GreyImage image{static_cast<int>(session.width), static_cast<int>(session.height), {}, {}};
  const std::size_t pixels = session.width * session.height;
  const std::size_t colours = session.channels >= 3 ? 3 : 1;
  image.grey.resize(pixels);
  if (session.channels > colours) image.opacity.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* pixel = &session.bytes[i * session.channels];
    const unsigned sum = colours == 3 ? (pixel[0] + pixel[1] + pixel[2] + 1u) / 3u : pixel[0];
    image.grey[i] = static_cast<std::uint8_t>(sum);
    if (session.channels > colours) image.opacity[i] = pixel[colours];
  }
  return image;
}

}  // namespace

GreyImage read_png(const std::filesystem::path& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) throw IoError(path.string(), 0, "the image cannot be opened");
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
  session.bytes.resize(session.width * session.height * session.channels);
  point_rows(session);
  if (!read_rows(session)) {
    throw IoError(path.string(), 0, std::string("the PNG is truncated or corrupt: ") + session.message);
  }
  return average_channels(session);
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
  point_rows(session);
  if (!session.info || !write_all(session, file.get()) || std::fclose(file.release()) != 0) {
    throw IoError(path.string(), 0, std::string("the PNG cannot be written: ") + session.message);
  }
}

}  // namespace slalom::maps::detail
