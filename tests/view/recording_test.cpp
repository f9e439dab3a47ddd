// Recordings: the same drive gives the same bytes, what is damaged is refused by name, a replay page holds
// what was recorded. That other programs read them is checked in view/page/test/mcap.mjs.
// The past of a drive: what it holds is bounded, and every stored tick is reached again exactly.
#include <gtest/gtest.h>

#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "view/car/car_subject.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/recorder.hpp"
#include "view/recording/replay.hpp"
#include "view/session/timeline.hpp"

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

/// A subject whose state holds 2 MiB; the first value counts.
class Large final : public SolverSubject {
 public:
  std::unique_ptr<Subject> clone() const override { return std::make_unique<Large>(); }
  const SubjectFacts& facts() const override { return facts_; }
  std::vector<double> start() const override { return std::vector<double>((2u << 20) / sizeof(double)); }
  double time_step() const override { return 1.0 / 40; }
  const SolverOptions* options() const override { return nullptr; }
  void set_options(const SolverOptions&) override {}
  const SolveResult& solve(std::span<const double>, const SolveRequest&) override { return solve_; }
  std::span<const double> inputs() const override { return {}; }
  Trajectories roll_out(std::span<const double>, std::span<const float>) override { return {}; }
  std::vector<double> step(std::span<const double> state, std::span<const double>) override {
    std::vector<double> next(state.begin(), state.end());
    next[0] = std::fmod(31 * next[0], 1009) + 1;
    return next;
  }
  std::vector<maps::Pose> poses(std::span<const double>) override { return {}; }
  std::vector<Shape> shapes() override { return {}; }
  std::vector<Line> figure(std::span<const double>) override { return {}; }
  void place(std::span<double> state, const maps::Pose& to) override { state[0] = to.x; }
  void move(int, const maps::Pose&) override {}

 private:
  SubjectFacts facts_;
  SolveResult solve_;
};

Drives large() {
  return {Run(Polymorphic<Subject>(std::make_unique<Large>()))};
}

constexpr std::size_t frame_size = 64u << 10;

/// Drives ticks of 1/40 s with frames that cannot be compressed further.
void drive(Timeline& past, Drives& drives, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    past.checkpoint(drives);
    DrivenTick driven{.tick = drives.ticks(),
                      .frame = shared(std::string(frame_size, static_cast<char>(drives.ticks())))};
    drives.tick(driven.records);
    driven.keep_scalars(3);
    past.keep(std::move(driven));
  }
}

TEST(Timeline, HoldsNoMoreThanItsBounds) {
  Timeline past(1.0 / 40);
  Drives drives = large();
  const std::size_t before = allocated_bytes();
  for (int second = 0; second < 150; ++second) {
    drive(past, drives, 40);
    EXPECT_LE(past.frame_bytes(), Timeline::max_frame_bytes);
    EXPECT_LE(past.copy_bytes(), Timeline::max_copy_bytes);
  }
  EXPECT_EQ(past.newest(), 5999);
  EXPECT_GT(past.newest() - past.oldest(), 2000) << "frames of 64 KiB fill 128 MiB with 2047 ticks";
  if (before == 0) return;  // the system does not tell
  EXPECT_GT(past.copy_bytes(), Timeline::max_copy_bytes / 2) << "the bytes of copies are measured";
  EXPECT_LE(allocated_bytes() - before, Timeline::max_frame_bytes + Timeline::max_copy_bytes + (8u << 20));
}

TEST(Timeline, ReachesEveryStoredTickExactly) {
  Timeline past(1.0 / 40);
  Drives drives = large();
  drive(past, drives, 300);
  past.note(300, place_body({500, 0, 0}));
  past.act(drives);
  drive(past, drives, 3000);
  for (const int tick : {past.oldest(), past.oldest() + 333, past.newest() - 1}) {
    Drives again = large();
    while (again.ticks() < tick) {
      again.tick({});
      if (again.ticks() == 300) place_body({500, 0, 0})(again);
    }
    std::optional<Drives> reached;
    while (!past.approach(reached, tick)) continue;
    EXPECT_EQ(reached->driven.state, again.driven.state) << tick;
    EXPECT_EQ(past.frame(tick)->front(), static_cast<char>(tick));
  }
}

}  // namespace

}  // namespace slalom::view
