// The past of a drive: what it holds is bounded, and every stored tick is reached again exactly.
#include "view/session/timeline.hpp"

#include <gtest/gtest.h>

namespace slalom::view {
namespace {

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
