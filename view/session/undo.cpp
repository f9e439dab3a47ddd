#include "view/session/undo.hpp"

#include <algorithm>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t max_changes = 200;

bool is_same(const AddBody& a, const AddBody& b) {
  return a.kind == b.kind && a.pose.x == b.pose.x && a.pose.y == b.pose.y && a.pose.yaw == b.pose.yaw &&
         a.length == b.length && a.width == b.width;
}

}  // namespace

void UndoHistory::remember(Replaced before, int drag) {
  if (drag != 0 && drag == std::exchange(drag_, drag)) return;
  drag_ = drag;
  undo_.push_back(std::move(before));
  if (undo_.size() > max_changes) undo_.erase(undo_.begin());
  redo_.clear();
}

std::optional<Replaced> UndoHistory::take(bool again, const vehicle::Configuration& options,
                                          const SetBodies& bodies) {
  auto& from = again ? redo_ : undo_;
  while (!from.empty()) {
    Replaced last = std::move(from.back());
    from.pop_back();
    const auto* before = std::get_if<SetBodies>(&last);
    if (before && std::ranges::equal(before->bodies, bodies.bodies, is_same)) continue;
    (again ? undo_ : redo_).push_back(before ? Replaced(bodies) : Replaced(options));
    drag_ = 0;
    return last;
  }
  return {};
}

void UndoHistory::forget_bodies() {
  for (auto* changes : {&undo_, &redo_})
    std::erase_if(*changes, [](const Replaced& each) { return std::holds_alternative<SetBodies>(each); });
}

}  // namespace slalom::view
