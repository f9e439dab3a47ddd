#include "tools/bags/ros_bag.hpp"

#include <cstdint>
#include <cstring>
#include <map>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"

namespace slalom::tools {
namespace {

constexpr std::uint64_t max_bytes = std::uint64_t{1} << 32;
constexpr std::string_view magic = "#ROSBAG V2.0\n";

enum class Op : unsigned char { message = 2, bag = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

using Fields = std::map<std::string, std::string_view, std::less<>>;

/// Takes bytes from the front of a text. Throws IoError where there are too few.
class Bytes {
 public:
  Bytes(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  bool done() const { return bytes_.empty(); }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size())
      throw IoError(file_, 0, "is damaged or incomplete; `rosbag reindex` may repair it");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  /// A text behind its length.
  std::string_view block() { return take(number(take(4))); }

  static std::uint32_t number(std::string_view four) {
    std::uint32_t value = 0;
    std::memcpy(&value, four.data(), sizeof value);
    return value;
  }

 private:
  std::string_view bytes_;
  const std::string& file_;
};

/// The fields `name=value` of a header.
Fields fields_of(std::string_view header, const std::string& file) {
  Fields fields;
  for (Bytes rest(header, file); !rest.done();) {
    const std::string_view field = rest.block();
    const auto equals = field.find('=');
    if (equals == std::string_view::npos) throw IoError(file, 0, "is damaged: a header has no '='");
    fields.emplace(field.substr(0, equals), field.substr(equals + 1));
  }
  return fields;
}

struct Connection {
  std::string topic, type;
};

class Reader {
 public:
  Reader(const std::string& file, const std::function<void(const BagMessage&)>& take)
      : file_(file), take_(take) {}

  /// The records of the file, or of a chunk, which holds no further chunk.
  void records(std::string_view bytes, bool in_chunk = false) {
    for (Bytes rest(bytes, file_); !rest.done();) {
      const Fields fields = fields_of(rest.block(), file_);
      const std::string_view data = rest.block();
      switch (static_cast<Op>(field(fields, "op", 1)[0])) {
        case Op::chunk:
          if (in_chunk) throw IoError(file_, 0, "is damaged: a chunk is within a chunk");
          chunk(fields, data);
          break;
        case Op::connection:
          connection(fields, data);
          break;
        case Op::message:
          message(fields, data);
          break;
        default:  // indexes: everything is read anyway
          break;
      }
    }
  }

 private:
  /// A header's field; of `size` bytes unless that is 0.
  std::string_view field(const Fields& fields, const std::string& name, std::size_t size) const {
    const auto found = fields.find(name);
    if (found == fields.end() || (size != 0 && found->second.size() != size))
      throw IoError(file_, 0, "is damaged: a record has no " + name);
    return found->second;
  }

  void chunk(const Fields& fields, std::string_view data) {
    const std::string_view compression = field(fields, "compression", 0);
    if (compression != "none")
      throw IoError(file_, 0,
                    "is compressed with " + std::string(compression) + ": `rosbag decompress " + file_ + "`");
    records(data, true);
  }

  void connection(const Fields& fields, std::string_view data) {
    const Fields said = fields_of(data, file_);
    connections_[Bytes::number(field(fields, "conn", 4))] = {std::string(field(fields, "topic", 0)),
                                                             std::string(field(said, "type", 0))};
  }

  void message(const Fields& fields, std::string_view data) {
    const auto found = connections_.find(Bytes::number(field(fields, "conn", 4)));
    if (found == connections_.end()) throw IoError(file_, 0, "is damaged: a message has no topic");
    take_({found->second.topic, found->second.type, data});
  }

  const std::string& file_;
  const std::function<void(const BagMessage&)>& take_;
  std::map<std::uint32_t, Connection> connections_;
};

}  // namespace

bool is_bag(const std::string& file) {
  return file.size() >= 4 && file.compare(file.size() - 4, 4, ".bag") == 0;
}

void read_bag(const std::string& file, const std::function<void(const BagMessage&)>& take) {
  const std::string bytes = read_file(file, max_bytes);
  if (bytes.compare(0, magic.size(), magic) != 0) throw IoError(file, 0, "is not a ROS 1 bag (format 2.0)");
  Reader(file, take).records(std::string_view(bytes).substr(magic.size()));
}

}  // namespace slalom::tools
