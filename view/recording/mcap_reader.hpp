#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

/// Reads MCAP files (https://mcap.dev/spec) from their beginning, so that one that was cut opens too.
namespace slalom::view::mcap {

/// A message and its channel. Valid during the call only.
struct MessageView {
  std::string_view topic, schema;  ///< names of the channel's topic and schema
  std::string_view encoding;       ///< encoding of the message, such as "json" or "cdr"
  std::uint64_t time = 0;          ///< ns, when it was logged
  std::string_view data;           ///< the message
};

/// The receivers of a file's content. Without `message`, chunks are not opened.
struct Receivers {
  std::function<void(const MessageView&)> message;                               ///< each message
  std::function<void(std::string_view name, std::string_view data)> attachment;  ///< each attachment
};

/// Reads a file, and returns the number of bytes after the last record that is whole: 0 unless it was cut.
/// Throws IoError if it is not an MCAP file, is damaged, has a chunk that is compressed with neither nothing
/// nor zstd or larger than 1 GiB or, beyond 64 MiB, 1000 times its compressed size, or is a cut one without
/// `may_be_cut`.
std::uint64_t read_records(const std::string& file, bool may_be_cut, const Receivers& receivers);

}  // namespace slalom::view::mcap
