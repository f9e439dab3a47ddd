#include "slalom/maps/ros_map.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <set>

#include "slalom/core/error.hpp"
#include "slalom/core/files/write_file.hpp"
#include "slalom/core/option_access.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "slalom/maps/yaml_text.hpp"

namespace slalom::maps {
namespace {

constexpr int free_grey = 254, unknown_grey = 205;  // as map_saver writes them

enum class Mode { trinary, scale, raw };

/// The contents of the yaml file.
struct Header {
  std::string image;
  double resolution = 0;
  Pose origin;
  bool negate = false;
  double occupied_threshold = 0;
  double free_threshold = 0;
  Mode mode = Mode::trinary;
};

/// Reads keys of one yaml file; every error names the file, the line, the key, the value and the rule.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {
    root_ = YAML::Load(yaml_text(path));
    if (!root_.IsMap()) throw IoError(path.string(), 1, "a map's YAML file must hold `key: value` pairs");
    refuse_repeated_keys();
  }

  std::optional<YAML::Node> find(const char* key) const {
    const YAML::Node node = root_[key];
    if (!node.IsDefined() || node.IsNull()) return std::nullopt;
    return node;
  }

  YAML::Node need(const char* key) const {
    if (auto node = find(key)) return *node;
    throw IoError(path_.string(), 0, std::string("the key `") + key + "` is missing");
  }

  [[noreturn]] void fail(const char* key, const YAML::Node& node, const char* rule) const {
    const std::string value = node.IsScalar() ? node.Scalar() : YAML::Dump(node);
    throw IoError(path_.string(), node.Mark().line + 1,
                  std::string("`") + key + ": " + value + "`: must be " + rule);
  }

  /// Reads a number that is a part of the key's value, `whole`.
  double number(const char* key, const YAML::Node& node, const char* rule, const YAML::Node& whole) const {
    const auto value = node.IsScalar() ? finite_number(node.Scalar()) : std::nullopt;
    if (!value) fail(key, whole, rule);
    return *value;
  }

 private:
  /// Repeated keys are an error, though yaml-cpp keeps one of them.
  void refuse_repeated_keys() const {
    std::set<std::string> seen;
    for (const auto& entry : root_)
      if (entry.first.IsScalar() && !seen.insert(entry.first.Scalar()).second)
        throw IoError(path_.string(), entry.first.Mark().line + 1,
                      "the key `" + entry.first.Scalar() + "` is a duplicate");
  }

  std::filesystem::path path_;
  YAML::Node root_;
};

double threshold(const Reader& reader, const char* key) {
  constexpr const char* rule = "a number within 0 to 1";
  const YAML::Node node = reader.need(key);
  const double value = reader.number(key, node, rule, node);
  if (value < 0 || value > 1) reader.fail(key, node, rule);
  return value;
}

bool read_negate(const Reader& reader) {
  const YAML::Node node = reader.need("negate");
  bool flag = false;
  int number = 0;
  if (YAML::convert<int>::decode(node, number) && (number == 0 || number == 1)) return number == 1;
  if (YAML::convert<bool>::decode(node, flag)) return flag;
  reader.fail("negate", node, "0 or 1");
}

Mode read_mode(const Reader& reader) {
  const auto node = reader.find("mode");
  if (!node) return Mode::trinary;
  const std::string value = node->IsScalar() ? node->Scalar() : "";
  if (value == "trinary") return Mode::trinary;
  if (value == "scale") return Mode::scale;
  if (value == "raw") return Mode::raw;
  reader.fail("mode", *node, "trinary, scale or raw");
}

Header read_header(const std::filesystem::path& path, MapRule rule) {
  const Reader reader(path);
  Header header;

  constexpr const char* positive = "a number within 1e-4 to 1000 (m per pixel)";
  const YAML::Node resolution = reader.need("resolution");
  header.resolution = reader.number("resolution", resolution, positive, resolution);
  if (!(header.resolution >= 1e-4) || header.resolution > 1000)
    reader.fail("resolution", resolution, positive);

  constexpr const char* triple =
      "[x, y, yaw] (m, m, rad), each coordinate within 1e7 m of 0, yaw within 1e6 rad";
  const YAML::Node origin = reader.need("origin");
  if (!origin.IsSequence() || origin.size() != 3) reader.fail("origin", origin, triple);
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = reader.number("origin", origin[i], triple, origin);
  header.origin = {values[0], values[1], values[2]};
  if (!is_plausible(header.origin)) reader.fail("origin", origin, triple);

  const YAML::Node image = reader.need("image");
  if (!image.IsScalar() || image.Scalar().empty()) reader.fail("image", image, "a file name");
  header.image = image.Scalar();
  if (rule == MapRule::grey_threshold) return header;

  header.negate = read_negate(reader);
  header.mode = read_mode(reader);
  header.occupied_threshold = threshold(reader, "occupied_thresh");
  header.free_threshold = threshold(reader, "free_thresh");
  if (header.free_threshold > header.occupied_threshold) {
    reader.fail("free_thresh", reader.need("free_thresh"), "at most occupied_thresh");
  }
  return header;
}

Occupancy classify(const Header& header, MapRule rule, int grey) {
  if (rule == MapRule::grey_threshold) return grey <= 128 ? Occupancy::occupied : Occupancy::free;
  if (header.negate) grey = 255 - grey;
  if (header.mode == Mode::raw) {
    return grey == 0 ? Occupancy::free : grey == 100 ? Occupancy::occupied : Occupancy::unknown;
  }
  const double p = (255 - grey) / 255.0;
  if (p > header.occupied_threshold) return Occupancy::occupied;
  return p < header.free_threshold ? Occupancy::free : Occupancy::unknown;
}

/// Whether the grey 205 of map_saver, which is free by the thresholds, means unknown: at least one pixel in a
/// hundred has it, and lighter ones are the free floor. The map saver of nav2 (Humble) writes unknown as 205
/// beside `free_thresh: 0.25`, which lies above its occupancy of 0.196.
bool grey_205_is_unknown(const Header& header, const GreyImage& image) {
  if (header.negate || header.mode != Mode::trinary ||
      classify(header, MapRule::map_server, unknown_grey) != Occupancy::free)
    return false;
  const auto count = [&](auto matches) {
    return std::count_if(image.grey.begin(), image.grey.end(), matches);
  };
  return 100 * count([](int grey) { return grey == unknown_grey; }) >= std::ssize(image.grey) &&
         count([](int grey) { return grey > unknown_grey; }) > 0;
}

}  // namespace

OccupancyGrid load_ros_map(const std::filesystem::path& yaml_file, MapRule rule,
                           std::vector<std::string>* notes) {
  const Header header = read_header(yaml_file, rule);
  const GreyImage image = load_image(yaml_file.parent_path() / header.image);
  std::array<Occupancy, 256> table{};
  for (int grey = 0; grey < 256; ++grey) table[grey] = classify(header, rule, grey);
  if (rule == MapRule::map_server && grey_205_is_unknown(header, image)) {
    table[unknown_grey] = Occupancy::unknown;
    if (notes)
      notes->push_back(yaml_file.filename().string() +
                       ": the grey 205 is read as unknown, as map savers write it, though `free_thresh: " +
                       to_text(header.free_threshold) +
                       "` makes it free; 0.196 says the same in the file, and any other grey is free");
  }
  const bool see_opacity = !image.opacity.empty() && rule == MapRule::map_server;

  OccupancyGrid grid{image.width, image.height, header.resolution, header.origin, {}};
  grid.cells.resize(image.grey.size());
  const auto width = static_cast<std::size_t>(image.width);
  for (int row = 0; row < image.height; ++row) {
    const std::size_t from = static_cast<std::size_t>(image.height - 1 - row) * width;
    const std::size_t to = static_cast<std::size_t>(row) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const bool transparent = see_opacity && image.opacity[from + x] < 128;
      grid.cells[to + x] = transparent ? Occupancy::unknown : table[image.grey[from + x]];
    }
  }
  return grid;
}

void save_ros_map(const OccupancyGrid& grid, const std::filesystem::path& yaml_file) {
  check_grid(grid);
  GreyImage image{grid.width, grid.height, {}, {}};
  image.grey.resize(grid.cells.size());
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Occupancy cell = grid.at(column, row);
      const int grey = cell == Occupancy::occupied ? 0 : cell == Occupancy::free ? free_grey : unknown_grey;
      image.grey[static_cast<std::size_t>(grid.height - 1 - row) * static_cast<std::size_t>(grid.width) +
                 static_cast<std::size_t>(column)] = static_cast<std::uint8_t>(grey);
    }
  }
  auto image_file = yaml_file;
  image_file.replace_extension(".png");
  save_png(image, image_file);

  YAML::Emitter yaml;
  yaml << YAML::BeginMap << YAML::Key << "image" << YAML::Value << image_file.filename().string();
  yaml << YAML::Key << "resolution" << YAML::Value << to_text(grid.resolution);
  yaml << YAML::Key << "origin" << YAML::Value << YAML::Flow << YAML::BeginSeq << to_text(grid.origin.x)
       << to_text(grid.origin.y) << to_text(grid.origin.yaw) << YAML::EndSeq;
  yaml << YAML::Key << "negate" << YAML::Value << 0;
  yaml << YAML::Key << "occupied_thresh" << YAML::Value << "0.65";
  yaml << YAML::Key << "free_thresh" << YAML::Value << "0.196" << YAML::EndMap;
  write_file(yaml_file, yaml.c_str() + std::string("\n"));
}

}  // namespace slalom::maps
