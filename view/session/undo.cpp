#include "view/session/undo.hpp"

#include <algorithm>
#include <utility>

namespace slalom::view {
namespace {

constexpr std::size_t most = 200;  // changes that are remembered

std::optional<Replaced> take(std::vector<Replaced>& from, const SetBodies& present) {
  while (!from.empty()) {
    Replaced last = std::move(from.back());
    from.pop_back();
    const auto* bodies = std::get_if<SetBodies>(&last);
    if (!bodies || !is_same(*bodies, present)) return last;
  }
  return {};
}

}  // namespace

bool is_same(const SetBodies& a, const SetBodies& b) noexcept {
  return std::ranges::equal(a.bodies, b.bodies, [](const AddBody& x, const AddBody& y) {
    return x.kind == y.kind && x.pose.x == y.pose.x && x.pose.y == y.pose.y && x.pose.yaw == y.pose.yaw &&
           x.length == y.length && x.width == y.width;
  });
}

void UndoHistory::remember(Replaced before) {
  undo_.push_back(std::move(before));
  if (undo_.size() > most) undo_.erase(undo_.begin());
  redo_.clear();
  drag_ = 0;
}

void UndoHistory::remember_drag(SetBodies before, int drag) {
  if (drag != 0 && drag == drag_) return;
  remember(std::move(before));
  drag_ = drag;
}

std::optional<Replaced> UndoHistory::take_undo(const SetBodies& present) {
  return take(undo_, present);
}

std::optional<Replaced> UndoHistory::take_redo(const SetBodies& present) {
  return take(redo_, present);
}

void UndoHistory::replaced(Replaced before, bool again) {
  (again ? undo_ : redo_).push_back(std::move(before));
  drag_ = 0;
}

void UndoHistory::forget_bodies() {
  for (auto* changes : {&undo_, &redo_})
    std::erase_if(*changes, [](const Replaced& each) { return std::holds_alternative<SetBodies>(each); });
}

void UndoHistory::clear() {
  undo_.clear();
  redo_.clear();
}

}  // namespace slalom::view
