#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "slalom/vehicle/configuration/configuration.hpp"
#include "view/session/simulation.hpp"

namespace slalom::view {

/// What a change replaced: the options, or the bodies that do not drive.
using Replaced = std::variant<vehicle::Configuration, SetBodies>;

/// Whether two lists have the same bodies in the same places.
bool is_same(const SetBodies& a, const SetBodies& b) noexcept;

/// The changes that can be undone and done again, newest last.
class UndoHistory {
 public:
  /// To be called before a change. What was undone cannot be done again after it.
  void remember(Replaced before);
  /// The same for the change of a place, of which many make one drag: those of the same `drag` count as one
  /// change. 0 is never the same.
  void remember_drag(SetBodies before, int drag);

  /// The last change that is not in effect any more, if any. `present` are the bodies now: a change of bodies
  /// that left nothing to undo, since the drive went back to before it, is skipped.
  std::optional<Replaced> take_undo(const SetBodies& present);
  std::optional<Replaced> take_redo(const SetBodies& present);
  /// What an undo, or with `again` the reverse, replaced.
  void replaced(Replaced before, bool again);

  /// Forgets changes of bodies: the world was made anew.
  void forget_bodies();
  void clear();

  std::size_t undos() const noexcept { return undo_.size(); }
  std::size_t redos() const noexcept { return redo_.size(); }

 private:
  std::vector<Replaced> undo_, redo_;
  int drag_ = 0;  ///< of the last change
};

}  // namespace slalom::view
