#include "tools/scenario/lap_json.hpp"

#include "json/json.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::tools {
namespace {

Json pose_json(const maps::Pose& pose) {
  return {pose.x, pose.y, pose.yaw};
}

/// Mean and 99th percentile; of no values, null.
Json error_json(std::vector<float> errors) {
  if (errors.empty()) return nullptr;
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const float error : errors) sum += static_cast<double>(error);
  return {{"mean", sum / static_cast<double>(errors.size())}, {"p99", evaluation::percentile(errors, 0.99)}};
}

Json localisation_json(const evaluation::LocalisationRecord& record) {
  return {{"error_m", error_json(record.error)},
          {"error_rad", error_json(record.yaw_error)},
          {"steps_without_pose", record.blind}};
}

Json overtaking_json(const evaluation::OvertakingRecord& record) {
  Json encounters = Json::array();
  for (const evaluation::Encounter& each : record.encounters)
    encounters.push_back({{"opponent", each.opponent},
                          {"time_s", each.time},
                          {"duration_s", each.duration},
                          {"end", evaluation::name(each.end)},
                          {"contacts", each.contacts},
                          {"contacts_caused", each.caused},
                          {"side_changes", each.side_changes}});
  return {
      {"opponent_contacts", record.contacts}, {"contacts_caused", record.caused}, {"encounters", encounters}};
}

}  // namespace

Json estimation_json(const evaluation::EstimationRecord& record) {
  const vehicle::ParameterEstimate& last = record.last;
  return {{"friction", last.friction},
          {"friction_deviation", last.friction_deviation},
          {"cautious_friction", last.cautious_friction},
          {"steering_gain", last.steering_gain},
          {"steering_gain_deviation", last.steering_gain_deviation},
          {"steering_offset_rad", last.steering_offset},
          {"delay_s", last.delay},
          {"delay_deviation_s", last.delay_deviation},
          {"confidence", last.confidence},
          {"informed_time_s", record.informed_time < 0 ? Json(nullptr) : Json(record.informed_time)},
          {"yaw_rate_rms", root_mean_square(record.yaw_rate_error)},
          {"slip_rms", root_mean_square(record.slip_error)},
          {"speed_rms", root_mean_square(record.speed_error)}};
}

double root_mean_square(const std::vector<float>& values) {
  double sum = 0;
  for (const float each : values) sum += static_cast<double>(each) * static_cast<double>(each);
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

const char* end_name(const evaluation::LapResult& lap) {
  return lap.finished ? "finished" : lap.cancelled ? "interrupted" : "timeout";
}

Json lap_json(const evaluation::LapResult& lap, int number) {
  Json status = Json::object();
  for (std::size_t i = 0; i < lap.planner_status.size(); ++i)
    if (lap.planner_status[i] > 0)
      status[vehicle::name(static_cast<vehicle::PlannerStatus>(i))] = lap.planner_status[i];
  Json collisions = Json::array(), obstacles = Json::array();
  for (const auto& collision : lap.first_collisions)
    collisions.push_back({{"time_s", collision.time},
                          {"pose", pose_json(collision.pose)},
                          {"body", collision.body < 0 ? Json("wall") : Json(collision.body)}});
  for (const auto& obstacle : lap.obstacles) obstacles.push_back(pose_json(obstacle));
  Json json{{"lap", number}};
  json.update(figures_json(lap));
  json.update({{"mean_sequence_cost", lap.mean_sequence_cost()},
               {"interrupted", lap.cancelled},
               {"planner_status", status},
               {"corrections", lap.corrections},
               {"first_collisions", collisions},
               {"obstacles", obstacles}});
  if (!lap.overtaking.encounters.empty() || lap.overtaking.contacts > 0)
    json["overtaking"] = overtaking_json(lap.overtaking);
  if (!lap.estimation.slip_error.empty()) json["estimation"] = estimation_json(lap.estimation);
  if (!lap.localisation.update_ms.empty()) json["localisation"] = localisation_json(lap.localisation);
  return json;
}

Json times_json(const std::vector<float>& milliseconds) {
  return {{"p50", evaluation::percentile(milliseconds, 0.5)},
          {"p99", evaluation::percentile(milliseconds, 0.99)},
          {"max", evaluation::percentile(milliseconds, 1)}};
}

std::vector<float> solve_times(const std::vector<evaluation::LapResult>& laps) {
  std::vector<float> all;
  for (const auto& lap : laps) all.insert(all.end(), lap.solve_ms.begin(), lap.solve_ms.end());
  return all;
}

}  // namespace slalom::tools
