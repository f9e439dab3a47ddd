// The past of a drive: what it holds is bounded, and every stored tick is reached again exactly.
#include "view/session/timeline.hpp"

#include <gtest/gtest.h>

namespace slalom::view {
namespace {

/// A drive whose copies hold 2 MiB.
struct Large {
  int steps = 0;
  int sum = 0;
  std::vector<char> ballast = std::vector<char>(2u << 20, 'x');

  int ticks() const { return steps; }
  void tick(const Delays&) { sum = 31 * sum % 1009 + ++steps; }
};
using Past = TimelineOf<Large>;

constexpr std::size_t frame_size = 64u << 10;

/// Drives ticks of 1/40 s with frames that cannot be compressed further.
void drive(Past& past, Large& drives, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    past.checkpoint(drives);
    const int tick = drives.ticks();
    drives.tick({});
    DrivenTick driven{tick, {}, shared(std::string(frame_size, static_cast<char>(tick)))};
    driven.keep_scalars(3);
    past.keep(std::move(driven));
  }
}

TEST(Timeline, HoldsNoMoreThanItsBounds) {
  Past past(1.0 / 40);
  Large drives;
  const std::size_t before = allocated_bytes();
  for (int second = 0; second < 150; ++second) {
    drive(past, drives, 40);
    EXPECT_LE(past.frame_bytes(), Past::max_frame_bytes);
    EXPECT_LE(past.copy_bytes(), Past::max_copy_bytes);
  }
  EXPECT_EQ(past.newest(), 5999);
  EXPECT_GT(past.newest() - past.oldest(), 2000) << "frames of 64 KiB fill 128 MiB with 2047 ticks";
  if (before == 0) return;  // the system does not tell
  EXPECT_GT(past.copy_bytes(), Past::max_copy_bytes / 2) << "the bytes of copies are measured";
  EXPECT_LE(allocated_bytes() - before, Past::max_frame_bytes + Past::max_copy_bytes + (8u << 20));
}

TEST(Timeline, ReachesEveryStoredTickExactly) {
  Past past(1.0 / 40);
  Large drives;
  drive(past, drives, 300);
  past.note(300, [](Large& each) { each.sum += 5; });
  past.act(drives);
  drive(past, drives, 3000);
  for (const int tick : {past.oldest(), past.oldest() + 333, past.newest() - 1}) {
    Large again;
    while (again.ticks() < tick) {
      again.tick({});
      if (again.ticks() == 300) again.sum += 5;
    }
    std::optional<Large> reached;
    while (!past.approach(reached, tick)) continue;
    EXPECT_EQ(reached->sum, again.sum) << tick;
    EXPECT_EQ(past.frame(tick)->front(), static_cast<char>(tick));
  }
}

}  // namespace
}  // namespace slalom::view
