#include "slalom/core/network/npz.hpp"

#include <cstring>
#include <string_view>
#include <utility>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom {
namespace {

constexpr std::uint64_t max_bytes = 16 << 20;
constexpr int max_arrays = 256;

/// A file, or a part of it, whose reads are checked.
class Bytes {
 public:
  Bytes(std::string_view all, std::string file, std::string part = "")
      : all_(all), file_(std::move(file)), part_(std::move(part)) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw IoError(file_, 0, (part_.empty() ? "" : "array '" + part_ + "': ") + what);
  }
  void require(bool holds, const std::string& what) const {
    if (!holds) fail(what);
  }
  std::string_view part(std::uint64_t at, std::uint64_t size) const {
    require(at <= all_.size() && size <= all_.size() - at, "is cut off");
    return all_.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
  }
  /// A little-endian number of 1 to 8 bytes.
  std::uint64_t number(std::uint64_t at, int size) const {
    std::uint64_t value = 0;
    const std::string_view bytes = part(at, static_cast<std::uint64_t>(size));
    for (int i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
    return value;
  }
  std::uint64_t size() const { return all_.size(); }
  const std::string& file() const { return file_; }

 private:
  std::string_view all_;
  std::string file_, part_;
};

/// CRC-32 as of ZIP (ISO 3309, polynomial 0xedb88320).
std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1u ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// Returns the text that follows a key in the header of an array, a Python dictionary of fixed form.
std::string_view entry(const Bytes& bytes, std::string_view header, const std::string& key) {
  const std::string quoted = "'" + key + "':";
  const std::size_t at = header.find(quoted);
  bytes.require(at != std::string_view::npos, "has no " + key + " in its header");
  std::string_view rest = header.substr(at + quoted.size());
  while (!rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  return rest;
}

std::vector<std::int64_t> shape_of(const Bytes& bytes, std::string_view header) {
  std::string_view text = entry(bytes, header, "shape");
  const std::size_t end = text.find(')');
  bytes.require(!text.empty() && text.front() == '(' && end != std::string_view::npos, "has no valid shape");
  text = text.substr(1, end - 1);
  std::vector<std::int64_t> shape;
  std::int64_t length = -1;
  for (const char c : text) {
    if (c >= '0' && c <= '9') {
      length = (length < 0 ? 0 : length) * 10 + (c - '0');
      bytes.require(length <= static_cast<std::int64_t>(max_bytes), "has too many values");
    } else {
      bytes.require(c == ',' || c == ' ', "has no valid shape");
      if (c == ',' && length >= 0) shape.push_back(std::exchange(length, -1));
    }
  }
  if (length >= 0) shape.push_back(length);
  bytes.require(shape.size() <= 4, "has more than 4 dimensions");
  return shape;
}

template <class Real>
void append(std::string_view data, std::vector<double>& values) {
  for (std::size_t at = 0; at < data.size(); at += sizeof(Real)) {
    Real value;
    std::memcpy(&value, data.data() + at, sizeof value);
    values.push_back(static_cast<double>(value));
  }
}

NpyArray read_array(const Bytes& bytes) {
  bytes.require(bytes.part(0, 6) == std::string_view("\x93NUMPY", 6), "is not a numpy array");
  const std::uint64_t version = bytes.number(6, 1), wide = version >= 2 ? 4 : 2;
  bytes.require(version >= 1 && version <= 3, "is of a format version other than 1 to 3");
  const std::uint64_t length = bytes.number(8, static_cast<int>(wide));
  const std::string_view header = bytes.part(8 + wide, length);
  bytes.require(entry(bytes, header, "fortran_order").substr(0, 5) == "False",
                "is in Fortran order: write it with numpy.ascontiguousarray");
  NpyArray array;
  array.shape = shape_of(bytes, header);
  std::uint64_t count = 1;
  for (const std::int64_t n : array.shape) {
    count *= static_cast<std::uint64_t>(n);
    bytes.require(count <= max_bytes, "has too many values");
  }
  std::string_view type = entry(bytes, header, "descr");
  bytes.require(!type.empty() && type.front() == '\'' && type.find('\'', 1) != std::string_view::npos,
                "has a type that is not read");
  type = type.substr(1, type.find('\'', 1) - 1);
  const std::uint64_t start = 8 + wide + length;
  const auto data = [&](std::uint64_t width) {
    bytes.require(bytes.size() - start == count * width, "has another number of bytes than its header says");
    return bytes.part(start, count * width);
  };
  if (type == "<f4") {
    append<float>(data(4), array.values);
  } else if (type == "<f8") {
    append<double>(data(8), array.values);
  } else if (type == "|b1") {
    append<bool>(data(1), array.values);
  } else if (type.substr(0, 2) == "<U" && array.shape.empty()) {
    const std::uint64_t left = bytes.size() - start;
    bytes.require(left % 4 == 0 && left <= 4 * 256, "is a text of more than 256 characters");
    for (std::uint64_t at = start; at < bytes.size(); at += 4) {
      const std::uint64_t character = bytes.number(at, 4);
      bytes.require(character < 128, "is a text with characters that are not ASCII");
      if (character != 0) array.text += static_cast<char>(character);
    }
  } else {
    bytes.fail("has the type " + std::string(type) +
               ", must be float32, float64, bool or a single text, little-endian");
  }
  return array;
}

/// Finds the start of the directory of a ZIP archive, and the number of files that it lists.
std::pair<std::uint64_t, int> find_directory(const Bytes& zip) {
  constexpr std::uint64_t size = 22;  // size of the record at the end, which numpy writes without a comment
  zip.require(zip.size() >= size && zip.number(zip.size() - size, 4) == 0x06054b50,
              "is not an .npz file of numpy.savez, or is truncated");
  const std::uint64_t end = zip.size() - size, count = zip.number(end + 10, 2);
  zip.require(count <= max_arrays, "holds more than " + std::to_string(max_arrays) + " arrays");
  return {zip.number(end + 16, 4), static_cast<int>(count)};
}

}  // namespace

std::map<std::string, NpyArray> read_npz(const std::filesystem::path& file) {
  const std::string content = read_file(file, max_bytes);
  const Bytes zip(content, file.string());
  auto [at, count] = find_directory(zip);
  std::map<std::string, NpyArray> arrays;
  for (int i = 0; i < count; ++i) {
    zip.require(zip.number(at, 4) == 0x02014b50, "has a damaged directory");
    const std::uint64_t method = zip.number(at + 10, 2), crc = zip.number(at + 16, 4),
                        size = zip.number(at + 24, 4), name_size = zip.number(at + 28, 2),
                        extra = zip.number(at + 30, 2), comment = zip.number(at + 32, 2),
                        local = zip.number(at + 42, 4);
    std::string name(zip.part(at + 46, name_size));
    zip.require(name.size() > 4 && name.substr(name.size() - 4) == ".npy",
                "holds '" + name + "', which is not an array: the name must end in .npy");
    name.resize(name.size() - 4);
    zip.require(method == 0, "array '" + name + "' is compressed: write it with numpy.savez");
    zip.require(zip.number(local, 4) == 0x04034b50, "has a damaged directory");
    const std::uint64_t start = local + 30 + zip.number(local + 26, 2) + zip.number(local + 28, 2);
    const std::string_view data = zip.part(start, size);
    zip.require(checksum(data) == crc, "array '" + name + "' is damaged: its checksum differs");
    zip.require(arrays.emplace(name, read_array(Bytes(data, zip.file(), name))).second,
                "holds array '" + name + "' twice");
    at += 46 + name_size + extra + comment;
  }
  return arrays;
}

}  // namespace slalom
