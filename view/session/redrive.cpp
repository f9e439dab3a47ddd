#include "view/session/redrive.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace slalom::view {
namespace {

constexpr int min_redriven_ticks = 2;

/// Brings a simulation to the state of another before tick `ticks`. False if the budget ended before.
bool follow(std::optional<Simulation>& follower, const Simulation& source, int ticks, RedriveBudget& budget) {
  if (!follower) follower.emplace(source.from_start());
  while (follower->ticks() < ticks) {
    if (!budget.take()) return false;
    follower->follow(source);
  }
  return true;
}

}  // namespace

bool RedriveBudget::take() {
  if (taken_ >= max_redriven_ticks || (taken_ >= min_redriven_ticks && Clock::now() >= end_)) return false;
  ++taken_;
  return true;
}

ContactSearch::ContactSearch(const evaluation::LapSetup& setup, std::uint64_t seed, int contact, double lead)
    : contact_(contact), lead_(lead), lap_(setup, seed) {}

bool ContactSearch::advance(RedriveBudget& budget) {
  const evaluation::LapSetup& setup = lap_.loop().setup();
  const double period = setup.control_period();
  const int most = static_cast<int>(setup.timeout() / period) + 1;
  const auto found = [&] { return std::ssize(lap_.loop().first_collisions()) > contact_; };
  while (!found()) {
    if (lap_.ticks() >= most)
      throw std::runtime_error(
          "the repeated lap has no such collision: another version drove the evaluation");
    if (!budget.take()) return false;
    lap_.tick({}, false);
  }
  hit_ = static_cast<int>(lap_.loop().first_collisions()[static_cast<std::size_t>(contact_)].time / period);
  return follow(start_, lap_, std::max(0, hit_ - static_cast<int>(lead_ / period)), budget);
}

bool Redrive::advance(const Simulation& drive, const Simulation* ghost_now, RedriveBudget& budget) {
  if (search) return search->advance(budget);
  const int ticks = view >= 0 ? view + 1 : drive.ticks();
  if (view >= 0) {
    if (!follow(present, drive, ticks, budget)) return false;
    if (ghost_now != nullptr && !follow(ghost, *ghost_now, ticks, budget)) return false;
  }
  return !copies || follow(copy, drive, ticks, budget);
}

void Redrive::go_back(int ticks) {
  if (view >= ticks - 1) {
    view = -1;
    present.reset();
    ghost.reset();
  }
  if (copy && copy->ticks() > ticks) copy.reset();
}

void Redrive::begin_anew() {
  view = -1;
  present.reset();
  ghost.reset();
  copy.reset();
}

}  // namespace slalom::view
