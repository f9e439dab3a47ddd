#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

/// Files as numpy.savez writes them.
namespace slalom::testing {

inline void append_number(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

inline std::uint32_t crc(const std::string& bytes) {
  std::uint32_t value = 0xffffffffu;
  for (const char byte : bytes) {
    value ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1u ? 0xedb88320u : 0u);
  }
  return ~value;
}

/// An array as numpy.save writes it.
inline std::string npy(const std::string& type, const std::string& shape, const std::string& data) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  header.resize(118, ' ');
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append_number(bytes, header.size(), 2);
  return bytes + header + data;
}
inline std::string floats(const std::string& shape, const std::vector<double>& values) {
  std::string data(values.size() * sizeof(double), '\0');
  if (!values.empty()) std::memcpy(data.data(), values.data(), data.size());
  return npy("<f8", shape, data);
}
inline std::string text(const std::string& words) {
  std::string data;
  for (const char c : words) append_number(data, static_cast<unsigned char>(c), 4);
  return npy("<U" + std::to_string(words.size()), "", data);
}

/// The arrays of a file with their names in it, "weights_0.npy".
using NpzArrays = std::vector<std::pair<std::string, std::string>>;

/// A ZIP archive without compression (or that says `method`), as numpy.savez writes it.
inline std::string zip(const NpzArrays& files, int method = 0) {
  std::string bytes, directory;
  for (const auto& [name, data] : files) {
    const std::size_t at = bytes.size();
    std::string common;
    append_number(common, static_cast<std::uint64_t>(method) << 32, 8);  // version, flags, method, time
    append_number(common, 0, 2);
    append_number(common, crc(data), 4);
    append_number(common, data.size(), 4);
    append_number(common, data.size(), 4);
    append_number(common, name.size(), 2);
    append_number(common, 0, 2);
    append_number(bytes, 0x04034b50, 4);
    bytes += common + name + data;
    append_number(directory, 0x02014b50, 4);
    append_number(directory, 20, 2);
    directory += common;
    append_number(directory, 0, 8);
    append_number(directory, 0, 2);
    append_number(directory, at, 4);
    directory += name;
  }
  const std::size_t at = bytes.size();
  bytes += directory;
  append_number(bytes, 0x06054b50, 4);
  append_number(bytes, 0, 4);
  append_number(bytes, files.size(), 2);
  append_number(bytes, files.size(), 2);
  append_number(bytes, directory.size(), 4);
  append_number(bytes, at, 4);
  append_number(bytes, 0, 2);
  return bytes;
}

/// A network of three inputs, two hidden neurons and one output.
inline NpzArrays network_files() {
  return {{"weights_0.npy", floats("2, 3", {1, 2, 3, 4, 5, 6})},
          {"biases_0.npy", floats("2,", {7, 8})},
          {"weights_1.npy", floats("1, 2", {9, 10})},
          {"biases_1.npy", floats("1,", {11})},
          {"activation.npy", text("relu")},
          {"input_mean.npy", floats("3,", {0, 1, 0})},
          {"residual.npy", npy("|b1", "", std::string(1, '\x01'))}};
}

}  // namespace slalom::testing
