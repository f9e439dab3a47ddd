// Recordings: the same drive gives the same bytes, what is damaged is refused by name, a replay page holds
// what was recorded. That other programs read them is checked in view/page/test/mcap.mjs.

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "view/car/car_subject.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/recorder.hpp"
#include "view/recording/replay.hpp"

namespace slalom::view {
namespace {

std::shared_ptr<const evaluation::Environment> environment() {
  return evaluation::load_environment(SLALOM_COURSES "/wren", evaluation::Protocol::true_physics, {});
}

vehicle::Configuration few_samples() {
  vehicle::Configuration configuration;
  vehicle::set_option(configuration, "samples", "64", "svg_mppi");
  vehicle::set_option(configuration, "svg_mppi.batches", "1");
  return configuration;
}

/// The first control steps of a drive, recorded; with `ghost` the same controller is the ghost too. Each
/// frame is there so many `times`.
std::string record(bool wall_clock, int ticks = 12, bool ghost = false, bool everything = true,
                   int times = 1) {
  const auto where = environment();
  evaluation::LapDrive loop({where, {few_samples()}, {.obstacles = 2}}, 5);
  std::ostringstream stream;
  Recorder recorder(stream,
                    {.settings = {{"settings", "{}"}}, .everything = everything, .wall_clock = wall_clock});
  recorder.add_text("{\"type\":\"hello\",\"control_period\":0.025}");
  const auto facts = car_facts(where.get());
  recorder.add_course(encode_scene(*facts));
  for (int i = 0; i < ticks; ++i)
    loop.step([&](const evaluation::ControlStep& tick) {
      const std::string frame = encode_car(facts, tick, 0.025, 0.1, 0);
      for (int k = 0; k < times; ++k) recorder.add_frame(ghost ? frame + encode_ghost_frame(frame) : frame);
    });
  recorder.finish();
  return std::move(stream).str();
}

/// Checks the block of tracked cars in the frame of a step with one opponent. Returns whether there is one.
bool shows_the_opponent(const evaluation::ControlStep& tick, const std::string& frame) {
  const std::string_view block = FrameReader(frame).block(Block::others);
  EXPECT_EQ(block.empty(), tick.others.empty());
  if (block.empty()) return false;
  PayloadReader others(block);
  EXPECT_EQ(others.get<std::uint32_t>(), 1u);
  others.take(3 * sizeof(float));
  const std::size_t hypotheses = others.get<std::uint16_t>(), times = others.get<std::uint16_t>();
  double sum = 0;
  for (std::size_t k = 0; k < hypotheses; ++k) sum += others.f32();
  EXPECT_NEAR(sum, 1, 1e-3) << "of the weights";
  const auto places = others.points(hypotheses * times);
  const maps::Pose opponent = tick.world.outline(1).pose;
  for (std::size_t k = 0; k < hypotheses; ++k)
    EXPECT_LT(std::hypot(places[k * times].x - opponent.x, places[k * times].y - opponent.y), 0.5)
        << "where it is now";
  return true;
}

TEST(CarFrame, ShowsWhereTheOtherCarsAreExpectedIfTheyAreTracked) {
  for (const auto mode : {evaluation::TrackingMode::off, evaluation::TrackingMode::exact}) {
    evaluation::LapDrive loop(
        {environment(), {few_samples()}, {.opponents = 1, .opponent_gap = 3, .tracking = mode}}, 5);
    const auto facts = car_facts();
    int shown = 0;
    for (int i = 0; i < 60; ++i)
      loop.step([&](const evaluation::ControlStep& tick) {
        shown += shows_the_opponent(tick, encode_car(facts, tick, 0.025, 0.1, 0));
      });
    if (mode == evaluation::TrackingMode::off)
      EXPECT_EQ(shown, 0);
    else
      EXPECT_GT(shown, 20);
  }
}

class McapRecording : public testing::TemporaryFolder {
 protected:
  std::string file(const std::string& bytes) const { return write("lap.mcap", bytes).string(); }
};

std::string refusal(const std::string& name) {
  try {
    load_replay(name);
  } catch (const IoError& error) {
    return error.what();
  }
  return "";
}

TEST_F(McapRecording, TheSameDriveGivesTheSameBytes) {
  const std::string first = record(false);
  EXPECT_EQ(first, record(false));
  EXPECT_EQ(first.find("/wall_clock"), std::string::npos);
  EXPECT_NE(record(true).find("/wall_clock"), std::string::npos);
  EXPECT_EQ(record(false, 12, true), record(false, 12, true))
      << "with what the ghost's controller considered";
}

/// The frames of a recording whose replay has one segment, and its text messages.
std::pair<std::vector<std::string>, std::string> frames_of(const std::string& name) {
  const auto segments = load_replay(name);
  EXPECT_EQ(segments.size(), 1u);
  std::vector<std::string> frames;
  std::string texts;
  const std::string all = gunzip(segments[0]);
  for (PayloadReader from(all); !from.empty();) {
    const auto kind = from.get<char>();
    const std::string message(from.take(from.get<std::uint32_t>()));
    if (kind == 0)
      texts += message;
    else if (!FrameReader(message).block(Block::scalars).empty())
      frames.push_back(message);
  }
  return {frames, texts};
}

double tick_of(const FrameReader& frame) {
  return PayloadReader(frame.block(Block::scalars)).get<double>();
}

TEST_F(McapRecording, AReplayHoldsEveryFrameInOrder) {
  const auto frames = frames_of(file(record(false, 12))).first;
  ASSERT_EQ(frames.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(tick_of(FrameReader(frames[i])), i);
}

TEST_F(McapRecording, ASmallOneHasEveryOtherFrameWithTwentyCandidates) {
  const auto [frames, texts] = frames_of(file(record(false, 12, true, false)));
  EXPECT_NE(texts.find("\"control_period\":0.05"), std::string::npos) << "from frame to frame";
  ASSERT_EQ(frames.size(), 12u / small_stride);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameReader reader(frames[i]), ghost(reader.block(Block::ghost_frame));
    EXPECT_EQ(tick_of(reader), i * small_stride);
    for (const FrameReader* each : {&reader, &ghost}) {
      PayloadReader candidates(each->block(Block::candidates));
      EXPECT_EQ(candidates.get<std::uint16_t>(), 20);
      EXPECT_TRUE(each->block(Block::cost_map).empty());
      EXPECT_TRUE(each->block(Block::guides).empty());
      EXPECT_FALSE(each->block(Block::plan).empty());
    }
  }
  EXPECT_LT(record(false, 40, false, false).size(), record(false, 40).size() / 3);
}

/// A recording may end anywhere: its program was killed, or the disk was full.
TEST_F(McapRecording, OneThatWasCutOpensUpToItsLastWholeRecord) {
  const std::string good = record(false, 12, false, true, 75);
  const auto whole = load_replay(file(good));
  ASSERT_EQ(whole.size(), 3u);
  std::size_t most = 0;
  for (std::size_t size = good.size() - 1; size > 0; size -= std::min<std::size_t>(size, good.size() / 23)) {
    const std::string cut = file(good.substr(0, size));
    std::uint64_t lost = 0;
    std::vector<std::string> segments;
    try {
      segments = load_replay(cut, &lost);
    } catch (const IoError&) {
      continue;  // no segment is whole
    }
    EXPECT_LE(lost, size);
    ASSERT_LE(segments.size(), whole.size());
    EXPECT_TRUE(std::equal(segments.begin(), segments.end(), whole.begin()));
    most = std::max(most, segments.size());
  }
  EXPECT_EQ(most, 3u);
}

TEST_F(McapRecording, RejectsOtherAndDamagedFiles) {
  const std::string good = record(false, 3);
  EXPECT_NE(refusal(file(std::string(60, 'x'))).find("not an MCAP recording"), std::string::npos);
  EXPECT_NE(refusal(file(good.substr(0, good.size() - 100))).find("incomplete"), std::string::npos);
  EXPECT_NE(refusal(file(good.substr(0, 20))).find("incomplete"), std::string::npos);
  std::string damaged = good;
  const std::size_t inside = damaged.find("replay/00000.gz") + 200;
  damaged[inside] = static_cast<char>(damaged[inside] ^ 1);
  EXPECT_NE(refusal(file(damaged)).find("checksum"), std::string::npos);
  EXPECT_NE(refusal("/no/such/file.mcap").find("cannot be read"), std::string::npos);
}

TEST(FrameEncoding, RoundTrips) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("a"), "YQ==");
  EXPECT_EQ(base64("ab"), "YWI=");
  EXPECT_EQ(base64("abc"), "YWJj");
  std::string text;
  for (int i = 0; i < 300000; ++i) text += static_cast<char>(std::int64_t{i} * i % 251);
  EXPECT_EQ(gunzip(gzip(text)), text);
  EXPECT_EQ(gunzip(gzip("")), "");
  EXPECT_THROW(gunzip(gzip(text).substr(0, 1000)), std::invalid_argument);
  EXPECT_THROW(gunzip("nothing"), std::invalid_argument);
}

TEST(ReplayPage, EmbedsTheReplay) {
  const std::string page = replay_page("<body><script>\"</body>\"</script></body></html>", {"abc", "d"});
  EXPECT_EQ(page,
            "<body><script>\"</body>\"</script><script type=\"application/x-slalom-replay\">YWJj</script>\n"
            "<script type=\"application/x-slalom-replay\">ZA==</script>\n</body></html>");
}

}  // namespace
}  // namespace slalom::view
