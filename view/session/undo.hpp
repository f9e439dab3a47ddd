#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "slalom/vehicle/configuration/configuration.hpp"
#include "view/session/drives.hpp"

namespace slalom::view {

/// The state that a change replaced: the options, or the bodies that do not drive.
using Replaced = std::variant<vehicle::Configuration, SetBodies>;

/// The changes that can be undone and done again, newest last; at most 200.
class UndoHistory {
 public:
  /// To be called with the state before a change. Many steps make one drag: those of the same `drag` count
  /// as one change; 0 is never the same. What was undone cannot be done again after a change.
  void remember(Replaced before, int drag = 0);
  /// Takes the last change back, or with `again` the last undo: returns the state to be restored, if there
  /// is one, and keeps `options` or `bodies`, which it replaces. A change of bodies that would restore the
  /// present ones, since the drive went back to before it, is skipped.
  std::optional<Replaced> take(bool again, const vehicle::Configuration& options, const SetBodies& bodies);
  /// Forgets changes of bodies: the world was made anew.
  void forget_bodies();

  std::size_t undos() const noexcept { return undo_.size(); }
  std::size_t redos() const noexcept { return redo_.size(); }

 private:
  std::vector<Replaced> undo_, redo_;
  int drag_ = 0;  ///< drag of the last change
};

}  // namespace slalom::view
