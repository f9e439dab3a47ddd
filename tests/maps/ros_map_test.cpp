#include "slalom/maps/ros_map.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <zlib.h>

#include <cstdlib>
#include <map>
#include <optional>
#include <stdexcept>

#include "slalom/core/error.hpp"
#include "slalom/maps/image.hpp"
#include "slalom/maps/yaml_text.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::maps::ros_map_test {
namespace {

using slalom::testing::TemporaryFolder;
using Path = std::filesystem::path;
constexpr auto f = Occupancy::free, o = Occupancy::occupied, u = Occupancy::unknown;

const std::string thresholds = "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
const std::string geometry = "image: map.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0.25]\n";
/// Three columns, two rows; the upper row first: black, unknown grey, white; white, white, black.
const std::string pgm = "P2\n# a comment\n3 2\n255\n0 205 254\n255 255 0\n";

class RosMap : public TemporaryFolder {
 protected:
  Path map(const std::string& yaml) { return write("map.yaml", yaml); }

  void expect_error(const Path& path, int line, const std::string& part) {
    try {
      load_ros_map(path);
      ADD_FAILURE() << "no error; expected one that says: " << part;
    } catch (const IoError& error) {
      EXPECT_EQ(error.line(), line) << error.what();
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
};

TEST_F(RosMap, RowZeroIsTheBottomOfTheImage) {
  write("map.pgm", pgm);
  const OccupancyGrid grid = load_ros_map(map(geometry + thresholds));
  ASSERT_EQ(grid.width, 3);
  ASSERT_EQ(grid.height, 2);
  EXPECT_EQ(grid.resolution, 0.05);
  EXPECT_EQ(grid.origin.x, -1.5);
  EXPECT_EQ(grid.origin.y, 2);
  EXPECT_EQ(grid.origin.yaw, 0.25);
  EXPECT_EQ(grid.cells, (std::vector<Occupancy>{f, f, o, o, u, f}));
}

TEST_F(RosMap, TheOriginAndTheSizeOfACellHaveLimits) {
  write("map.pgm", pgm);
  for (const char* origin : {"[1e16, 0, 0]", "[0, -1e300, 0]", "[1.1e7, 0, 0]", "[0, 0, 2e6]"})
    expect_error(map("image: map.pgm\nresolution: 0.05\norigin: " + std::string(origin) + "\n" + thresholds),
                 3,
                 std::string("origin: ") + origin +
                     "`: must be [x, y, yaw] (m, m, rad), each coordinate within 1e7 m");
  for (const char* size : {"1e-9", "1e-300", "1001"})
    expect_error(
        map("image: map.pgm\nresolution: " + std::string(size) + "\norigin: [0, 0, 0]\n" + thresholds), 2,
        "within 1e-4 to 1000");
}

TEST_F(RosMap, NegateSwapsBlackAndWhite) {
  write("map.pgm", pgm);
  EXPECT_EQ(load_ros_map(map(geometry + "negate: 1\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")).cells,
            (std::vector<Occupancy>{o, o, f, f, o, o}));
}

TEST_F(RosMap, TheUnknownGreyOfAMapSaverIsUnknownThoughTheThresholdMakesItFree) {
  const std::string humble = "mode: trinary\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n";
  std::vector<std::string> notes;
  write("map.pgm", pgm);
  EXPECT_EQ(load_ros_map(map(geometry + humble), MapRule::map_server, &notes).cells,
            (std::vector<Occupancy>{f, f, o, o, u, f}));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("map.yaml: the grey 205 is read as unknown"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find("free_thresh: 0.25"), std::string::npos) << notes[0];

  // A floor of this grey, a rare grey of a drawing, and thresholds that say unknown: as the file says.
  notes.clear();
  write("map.pgm", "P2 3 2 255 0 205 205 205 205 0");
  EXPECT_EQ(load_ros_map(map(geometry + humble), MapRule::map_server, &notes).at(1, 0), f);
  std::string drawing = "P2 101 1 255 205";
  for (int i = 0; i < 100; ++i) drawing += " 254";
  write("map.pgm", drawing);
  EXPECT_EQ(load_ros_map(map(geometry + humble), MapRule::map_server, &notes).at(0, 0), f);
  write("map.pgm", pgm);
  EXPECT_EQ(load_ros_map(map(geometry + thresholds), MapRule::map_server, &notes).at(1, 1), u);
  EXPECT_TRUE(notes.empty());
}

TEST_F(RosMap, RawModeReadsPercent) {
  write("map.pgm", "P2 3 2 255 0 100 50 255 0 100");
  EXPECT_EQ(load_ros_map(map(geometry + thresholds + "mode: raw\n")).cells,
            (std::vector<Occupancy>{u, f, o, f, o, u}));
}

TEST_F(RosMap, GreyThresholdIgnoresTheYamlRules) {
  write("map.pgm", "P2 3 2 255 128 129 205 0 1 255");
  const Path path = map("image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 1\n");
  EXPECT_EQ(load_ros_map(path, MapRule::grey_threshold).cells, (std::vector<Occupancy>{o, o, f, o, f, f}));
}

TEST_F(RosMap, BinaryPgmOfOneAndTwoBytes) {
  write("map.pgm", std::string("P5\n3 1\n100\n") + std::string("\0\x64\x32", 3));
  EXPECT_EQ(load_image(folder_ / "map.pgm").grey, (std::vector<std::uint8_t>{0, 255, 128}));
  write("map.pgm", std::string("P5\n2 1\n65535\n") + std::string("\0\0\xff\xff", 4));
  EXPECT_EQ(load_image(folder_ / "map.pgm").grey, (std::vector<std::uint8_t>{0, 255}));
}

TEST_F(RosMap, APgmMayEndWithALineEnd) {
  for (const char* text :
       {"P5 2 1 255 ab", "P5 2 1 255 ab\n", "P5 2 1 255 ab\r\n", "P2 2 1 255 97 98 \n\n# made by hand\n"}) {
    write("map.pgm", text);
    EXPECT_EQ(load_image(folder_ / "map.pgm").grey, (std::vector<std::uint8_t>{97, 98})) << text;
  }
}

TEST_F(RosMap, SavedMapsReadBackTheSame) {
  OccupancyGrid grid{37, 11, 0.0625, {1.0 / 3, -2.7e-5, 3.1}, {}};
  for (int i = 0; i < 37 * 11; ++i) grid.cells.push_back(static_cast<Occupancy>(i * 7919 % 31 % 3));
  save_ros_map(grid, folder_ / "saved.yaml");
  const OccupancyGrid read = load_ros_map(folder_ / "saved.yaml");
  const auto form = [](const OccupancyGrid& g) {
    return std::tuple(g.width, g.height, g.resolution, g.origin.x, g.origin.y, g.origin.yaw);
  };
  EXPECT_EQ(form(read), form(grid));
  EXPECT_EQ(read.cells, grid.cells);
  EXPECT_THROW(save_ros_map(grid, folder_ / "absent" / "saved.yaml"), IoError);
  grid.cells.pop_back();
  EXPECT_THROW(save_ros_map(grid, folder_ / "saved.yaml"), std::invalid_argument);
}

TEST_F(RosMap, BadYamlIsNamed) {
  write("map.pgm", pgm);
  expect_error(folder_ / "absent.yaml", 0, "does not exist");
  expect_error(folder_, 0, "does not exist or cannot be read");
  expect_error(map("image: [\n"), 2, "is not YAML");
  expect_error(map("just words\n"), 1, "key: value");
  expect_error(map(""), 1, "key: value");
  const std::string image = "image: map.pgm\n";
  expect_error(map(image + "origin: [0, 0, 0]\n" + thresholds), 0, "`resolution` is missing");
  for (const char* bad : {"0", "-0.05", ".nan", ".inf", "word", "[1]", "1e9"}) {
    expect_error(map(image + "resolution: " + bad + "\norigin: [0, 0, 0]\n" + thresholds), 2,
                 "`resolution: ");
  }
  for (const char* bad : {"[0, 0]", "[0, 0, 0, 0]", "5", "{x: 1}"}) {
    expect_error(map(image + "resolution: 0.05\norigin: " + bad + "\n" + thresholds), 3, "[x, y, yaw]");
  }
  for (const char* bad : {"[.nan, 0, 0]", "[0, .inf, 0]", "[0, 0, left]"}) {
    expect_error(map(image + "resolution: 0.05\norigin: " + bad + "\n" + thresholds), 3, "`origin: ");
  }
  expect_error(map("resolution: 0.05\norigin: [0, 0, 0]\n" + thresholds), 0, "`image` is missing");
  expect_error(map(image + "resolution: 0.05\norigin: [a, b, 0]\n" + thresholds), 3, "`origin: [a, b, 0]`");
  expect_error(map(geometry + thresholds + "resolution: 0.1\n"), 7, "`resolution` is a duplicate");
  expect_error(map(geometry + thresholds + "---\nnegate: 1\n"), 8, "only one YAML document");
  expect_error(map("image: [a]\nresolution: 0.05\norigin: [0, 0, 0]\n" + thresholds), 1, "a file name");
}

TEST_F(RosMap, YamlWithoutEndIsRefused) {
  write("map.pgm", pgm);
  expect_error(map(","), 1, "only one YAML document");
  expect_error(map(geometry + thresholds + "more: &more\n  within: *more\n"), 7, "anchors and aliases");
  expect_error(map(geometry + thresholds + "a: &a [1]\nb: [*a, *a]\n"), 7, "anchors and aliases");
  expect_error(map("a: " + std::string(33, '[') + std::string(33, ']')), 1, "deeper than 32 levels");
  expect_error(map("a: " + std::string(5000, '[')), 1, "deeper than 32 levels");
  expect_error(map("a: " + std::string(2 << 20, ' ')), 0, "at most 1048576 are read");
}

/// A PNG of a size whose pixels, all transparent, compress to a thousandth.
TEST_F(RosMap, AnImageThatGrowsWithoutLimitIsRefused) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  const auto chunk = [&](const std::string& content) {
    const auto sum =
        ::crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
    return number(static_cast<std::uint32_t>(content.size()) - 4) + content +
           number(static_cast<std::uint32_t>(sum));
  };
  write("map.pgm", "\x89PNG\r\n\x1a\n" +
                       chunk("IHDR" + number(11585) + number(11585) + std::string("\x08\x06\0\0\0", 5)) +
                       chunk("IDAT"));
  expect_error(map(geometry + thresholds), 0, "all pixels at most 67108864");
}

TEST_F(RosMap, BadThresholdsAreNamed) {
  write("map.pgm", pgm);
  expect_error(map(geometry + "occupied_thresh: 0.65\nfree_thresh: 0.2\n"), 0, "`negate` is missing");
  expect_error(map(geometry + "negate: 2\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"), 4,
               "`negate: 2`: must be 0 or 1");
  expect_error(map(geometry + "negate: 0\nfree_thresh: 0.2\n"), 0, "`occupied_thresh` is missing");
  expect_error(map(geometry + "negate: 0\noccupied_thresh: 0.5\n"), 0, "`free_thresh` is missing");
  expect_error(map(geometry + "negate: 0\noccupied_thresh: 1.5\nfree_thresh: 0.2\n"), 5,
               "`occupied_thresh: 1.5`");
  expect_error(map(geometry + "negate: 0\noccupied_thresh: 0.5\nfree_thresh: .nan\n"), 6,
               "`free_thresh: .nan`");
  expect_error(map(geometry + "negate: 0\noccupied_thresh: 0.2\nfree_thresh: 0.5\n"), 6,
               "at most occupied_thresh");
  expect_error(map(geometry + thresholds + "mode: grey\n"), 7, "`mode: grey`: must be trinary, scale or raw");
}

TEST_F(RosMap, BadImagesAreNamed) {
  const Path path = map(geometry + thresholds);
  expect_error(path, 0, "does not exist");
  for (const auto& [content, part] : {std::pair<std::string, std::string>{"", "must be a PNG or a grey PGM"},
                                      {"GIF89a", "must be a PNG or a grey PGM"},
                                      {"P2", "width"},
                                      {"P2 3", "height"},
                                      {"P2 0 3 255", "0 x 3 pixels"},
                                      {"P2 -3 3 255", "width"},
                                      {"P2 99999999999999999999 3 255", "width"},
                                      {"P2 32768 32768 255 0", "all pixels at most"},
                                      {"P2 2 2 0 0 0 0 0", "largest grey value"},
                                      {"P2 2 2 70000 0 0 0 0", "largest grey value"},
                                      {"P2 2 2 255 0 0 0", "truncated"},
                                      {"P2 2 2 255 0 0 0 256", "at most 255"},
                                      {"P2 2 2 255 0 0 0 x", "not a number"},
                                      {"P5 2 2 255 abc", "truncated"},
                                      {"P5 2 2 65535 abcdefg", "truncated"},
                                      {"P5 2 2 100 zzzz", "at most 100"},
                                      {"P5 2 2 255 abcdef", "more than the 2 x 2 pixels"},
                                      {"P5 2 1 65535 abcdef", "more than the 2 x 1 pixels"},
                                      {"P2 2 2 255 0 0 0 0 7", "more than the 2 x 2 pixels"},
                                      {"\x89PNG\r\n\x1a\n", "PNG"},
                                      {"\x89Png", "PNG"}}) {
    write("map.pgm", content);
    expect_error(path, 0, part);
  }
}

TEST(FiniteNumber, IsAWholeDecimalText) {
  for (const auto& [text, value] : std::map<std::string, double>{
           {"-2.9000000000000004", -2.9000000000000004}, {"+1", 1}, {".5", 0.5}, {"1.", 1}, {"-1e-3", -1e-3}})
    EXPECT_EQ(finite_number(text), value) << text;
  for (const char* text :
       {"", "+", "-", "1 ", " 1", "1,5", "0x10", "inf", ".inf", ".nan", "nan", "1e999", "one"})
    EXPECT_EQ(finite_number(text), std::nullopt) << text;
}

TEST_F(RosMap, ATruncatedPngIsNamed) {
  GreyImage image{64, 64, {}, {}};
  for (int i = 0; i < 64 * 64; ++i) image.grey.push_back(static_cast<std::uint8_t>(i * 7919 >> 3));
  save_png(image, folder_ / "whole.png");
  EXPECT_EQ(load_image(folder_ / "whole.png").grey, image.grey);
  const std::string bytes = testing::content(folder_ / "whole.png");
  for (const std::size_t length : {std::size_t{10}, std::size_t{30}, std::size_t{60}, bytes.size() / 2}) {
    EXPECT_THROW(load_image(write("cut.png", bytes.substr(0, length))), IoError) << length;
  }
  std::string huge = bytes;
  huge[16] = huge[20] = '\x7f';  // both sides near 2^31, behind a checksum that no longer fits
  EXPECT_THROW(load_image(write("huge.png", huge)), IoError);
}

TEST_F(RosMap, OnlyRegularFilesAreRead) {
  const Path pipe = folder_ / "map.pgm";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  expect_error(map(geometry + thresholds), 0, "regular file");
  expect_error(pipe, 0, "regular file");
}

TEST(RosMapData, PublishedMapsLoad) {
  const char* root = std::getenv("SLALOM_DATA_DIR");
  if (!root || !*root) GTEST_SKIP() << "no maps: set SLALOM_DATA_DIR to a folder that has berlin/map.yaml";
  for (const char* name : {"berlin/map.yaml", "spielberg/map.yaml", "oschersleben/Oschersleben_map.yaml"}) {
    const OccupancyGrid grid = load_ros_map(Path(root) / name);
    std::size_t counts[3] = {};
    for (const Occupancy cell : grid.cells) ++counts[static_cast<int>(cell)];
    std::cout << name << ": " << grid.width << " x " << grid.height << " at " << grid.resolution
              << " m; free " << counts[0] << ", occupied " << counts[1] << ", unknown " << counts[2] << '\n';
    EXPECT_GT(counts[0], 10000u) << name;
    EXPECT_GT(counts[1], 1000u) << name;
  }
}

}  // namespace
}  // namespace slalom::maps::ros_map_test
