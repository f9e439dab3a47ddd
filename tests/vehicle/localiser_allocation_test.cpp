#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "vehicle/localiser_drive.hpp"

namespace {
std::atomic<int> allocations{0};
}

__attribute__((noinline)) void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void* p) noexcept {
  std::free(p);
}
__attribute__((noinline)) void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace slalom::vehicle {
namespace {

TEST(Localiser, AllocatesNothingAfterConstruction) {
  const test::Place place("wren");
  Localiser localiser(place.course.map);
  test::Drive drive(place, place.at(0.2), 3);
  for (int i = 0; i < 30; ++i, drive.step()) {
    if (i == 10) localiser.start_at(drive.truth());
    if (i == 20) drive.kidnap(place.at(0.7));
    const LocaliserInput input = drive.input();
    const int before = allocations;
    ASSERT_GT(before, 0) << "nothing is counted";
    localiser.update(input);
    EXPECT_EQ(allocations, before);
  }
}

}  // namespace
}  // namespace slalom::vehicle
