#pragma once

#include <map>
#include <stdexcept>

#include "view/protocol/frame_writer.hpp"

namespace slalom::view {

/// The blocks of a binary message of the live view (docs/live-view.md). Throws std::invalid_argument if the
/// message ends too soon.
class FrameReader {
 public:
  explicit FrameReader(std::string_view message) {
    if (message.substr(0, 4) != "SLV1") throw std::invalid_argument("not a message of the live view");
    for (std::size_t at = 4; at + 8 <= message.size();) {
      std::uint16_t kind = 0;
      std::uint32_t length = 0;
      std::memcpy(&kind, message.data() + at, sizeof kind);
      std::memcpy(&length, message.data() + at + 4, sizeof length);
      if (at + 8 + length > message.size()) throw std::invalid_argument("a block is too short");
      blocks_[static_cast<Block>(kind)] = {at + 8, message.substr(at + 8, length)};
      at += 8 + ((std::size_t{length} + 3) & ~std::size_t{3});
    }
  }

  /// Returns the payload of a block; empty if the message has none of this kind.
  std::string_view block(Block kind) const {
    const auto found = blocks_.find(kind);
    return found == blocks_.end() ? std::string_view{} : found->second.bytes;
  }
  /// Returns the position of the payload in the message.
  std::size_t offset(Block kind) const { return blocks_.at(kind).offset; }

 private:
  struct Payload {
    std::size_t offset = 0;
    std::string_view bytes;
  };
  std::map<Block, Payload> blocks_;
};

/// Reads a payload from its beginning.
class PayloadReader {
 public:
  explicit PayloadReader(std::string_view payload) : payload_(payload) {}

  template <class T>
  T get() {
    T value{};
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  double f32() { return static_cast<double>(get<float>()); }
  maps::Pose pose() {
    const double x = get<double>(), y = get<double>();
    return {x, y, get<double>()};
  }
  std::vector<maps::Point> points(std::size_t count) {
    PayloadReader(*this).take(20 + 4 * count);  // throws before the memory is asked for
    const double x = get<double>(), y = get<double>(), unit = f32();
    std::vector<maps::Point> all(count);
    std::int16_t u = 0, v = 0;
    for (auto& point : all) {
      u = static_cast<std::int16_t>(u + get<std::int16_t>());
      v = static_cast<std::int16_t>(v + get<std::int16_t>());
      point = {x + unit * u, y + unit * v};
    }
    return all;
  }
  std::string_view take(std::size_t bytes) {
    if (bytes > payload_.size() - at_) throw std::invalid_argument("a block is too short");
    at_ += bytes;
    return payload_.substr(at_ - bytes, bytes);
  }
  bool empty() const { return at_ == payload_.size(); }
  void align() { at_ = std::min((at_ + 3) & ~std::size_t{3}, payload_.size()); }

 private:
  std::string_view payload_;
  std::size_t at_ = 0;
};

}  // namespace slalom::view
