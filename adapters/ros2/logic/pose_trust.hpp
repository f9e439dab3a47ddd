#pragma once

#include "slalom/vehicle/localisation/localiser.hpp"

namespace slalom::nodes {

/// Whether the estimate of the pose can be used for driving. After it could not, it must be good for a
/// moment, since some scans fit a wrong pose by chance; a mediocre one, as beside a parked car, for longer.
class PoseTrust {
 public:
  /// After a doubt the estimate is trusted again after `scans` consecutive ones of at least this health.
  explicit PoseTrust(int scans = 10, double health = 0.7) : scans_(scans), health_(health) {}

  /// Takes the next estimate. Returns whether it can be used.
  bool update(const vehicle::LocaliserOutput& seen) {
    usable_ = seen.status == vehicle::LocaliserStatus::ok;
    if (!usable_) doubt_ = vehicle::name(seen.status);
    good_ = usable_ ? good_ + 1 : 0;
    fine_ = usable_ && seen.health >= health_ ? fine_ + 1 : 0;
    holds_ = usable_ && (holds_ || fine_ >= scans_ || good_ >= mediocre_scans * scans_);
    return holds_;
  }
  /// Whether the last estimate can be used.
  bool holds() const { return holds_; }
  /// The reason why it cannot be used.
  std::string doubt() const { return doubt_ + (usable_ ? ", over, until it is sure" : ""); }

 private:
  static constexpr int mediocre_scans = 6;  ///< this many times as many scans of any health are as good

  int scans_;
  double health_;
  int good_ = 0, fine_ = 0;
  bool holds_ = false, usable_ = false;
  std::string doubt_ = "uncertain";  ///< the last status that was not ok
};

}  // namespace slalom::nodes
