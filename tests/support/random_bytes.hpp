#pragma once

#include <random>
#include <string>
#include <vector>

namespace slalom::fuzz {

/// `count` texts of `size` random bytes, the same at every call.
inline std::vector<std::string> random_bytes(int count, std::size_t size) {
  std::mt19937_64 random(1);
  std::vector<std::string> all(static_cast<std::size_t>(count), std::string(size, '\0'));
  for (std::string& each : all)
    for (char& byte : each) byte = static_cast<char>(random() & 255u);
  return all;
}

}  // namespace slalom::fuzz
