#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "slalom/core/polymorphic.hpp"
#include "slalom/view/subject.hpp"
#include "view/protocol/messages.hpp"
#include "view/session/playback.hpp"

namespace slalom::view {

/// A user's own problem and where its state is. A copy continues bit for bit like the original.
struct Run {
  Polymorphic<Subject> subject;
  std::vector<double> state;
  double period = 0;   ///< s of a control step
  int steps = 0;       ///< control steps until now
  double elapsed = 0;  ///< s since the last solve

  int ticks() const noexcept { return steps; }
  /// Solves from the present state.
  const SolveResult& decide();
  /// Applies the first input of the plan.
  void advance();
  void tick(const Delays&) {
    decide();
    advance();
  }
};

/// Drives a user's own problem for the pages that are open, and executes their commands.
class ProblemSession final : public Playback<Run> {
 public:
  /// Throws std::invalid_argument if the subject is not valid.
  ProblemSession(std::unique_ptr<Subject> subject, Server& server);

 private:
  void restart() override;
  void tick() override;
  Frame drive(Run& run);
  void keep(Frame frame);
  void perform(const Timeline::Action& action);
  const Subject& shown() { return viewed_ >= 0 ? *present().subject : *drives_->subject; }

  void obey(std::uint64_t client, const std::string& what, const Json& command) override;
  void set(const std::string& key, const std::string& value);
  void set_method(const std::string& method);
  void join(std::uint64_t client) override;
  void tell() override;
  std::string hello() const;
  std::string state();
  std::string options();
  double control_period() const override { return drives_->period; }
  std::size_t scalars() const override { return scalar_names(drives_->subject->facts()).size(); }

  Choices choices_;                                ///< methods
  std::map<std::string, SolverOptions> loaded_;    ///< options of each method before changes
  std::map<std::string, std::string> parameters_;  ///< parameters of the problem before changes
  Bounds bounds_;
  std::vector<int> collided_;  ///< steps that collided
  std::string told_options_;   ///< message with the options that the pages have
  bool edited_ = false;
};

}  // namespace slalom::view
