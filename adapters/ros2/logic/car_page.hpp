#pragma once

#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/planner/planner.hpp"
#include "slalom/view/monitor.hpp"

namespace slalom::nodes {

/// The page of the live view, which shows what the planner of a car plans and changes nothing.
class CarPage {
 public:
  /// Serves the page of a planner to this computer. `course`: the line to follow, and a map if there is one.
  /// Throws std::runtime_error if the port and the nine after it cannot be used.
  CarPage(std::uint16_t port, const vehicle::Configuration& configuration, const vehicle::Planner& planner,
          const maps::LaserScanView& scan, view::SubjectFacts course);

  const std::string& address() const noexcept { return page_.address(); }
  /// Shows a plan that was just made. While no page is open nothing happens; else up to 160 samples are
  /// predicted and copied. Does not wait, and does not allocate after the first plan.
  void show(const vehicle::Planner& planner, const vehicle::PlannerInput& input,
            const vehicle::PlannerOutput& output) noexcept;

 private:
  class Steps;
  explicit CarPage(std::uint16_t port, std::unique_ptr<Steps> steps);

  Steps* steps_;
  view::MonitorPage page_;
};

}  // namespace slalom::nodes
