#pragma once

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "golden.hpp"
#include "slalom/vehicle/published/options.hpp"

/// The recorded rollouts of the published program, and the options with which they were recorded.
namespace slalom::vehicle::testing {

/// A rollout of the published program as recorded.
struct Case {
  int id = 0, parameters = 0;
  std::string map;
  double start[5] = {};
  std::vector<double> inputs{};
  double state_cost = 0, collision_cost = 0, sample_cost = 0;
  std::vector<std::vector<double>> states{};  // 15 x {x, y, yaw, vel, steer, lx, ly, lyaw, lvel, lsteer}
};

inline std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

inline std::vector<Case> load_cases(const std::filesystem::path& folder) {
  std::vector<Case> cases;
  std::map<int, std::size_t> index;
  std::ifstream stream(folder / "cases.csv");
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    const auto cell = split(line);
    Case c{.id = std::stoi(cell.at(0)), .parameters = std::stoi(cell[2]), .map = cell[1]};
    for (std::size_t i = 0; i < 5; ++i) c.start[i] = std::stod(cell[3 + i]);
    for (std::size_t i = 0; i < 14; ++i) c.inputs.push_back(std::stod(cell[8 + i]));
    c.state_cost = std::stod(cell[22]);
    c.collision_cost = std::stod(cell[23]);
    c.sample_cost = std::stod(cell[24]);
    index[c.id] = cases.size();
    cases.push_back(c);
  }
  for (const auto& row : slalom::testing::read_csv_numbers(folder / "states.csv", true)) {
    const auto found = index.find(static_cast<int>(row[0]));
    if (found != index.end()) cases[found->second].states.emplace_back(row.begin() + 2, row.end());
  }
  return cases;
}

inline VehicleOptions options_of(const nlohmann::json& set) {
  VehicleOptions o = published::vehicle_options();
  o.time_step = set.at("prediction_interval");
  o.front_length = set.at("lf");
  o.rear_length = set.at("lr");
  o.steer_time_constant = set.at("steer_1st_delay");
  o.dead_time = set.at("steer_delay");
  const std::string mode = set.at("speed_prediction_mode");
  o.speed = mode == "reference"  ? SpeedModel::reference
            : mode == "constant" ? SpeedModel::constant
                                 : SpeedModel::linear;
  o.cost.distance_weight = set.at("q_dist");
  o.cost.yaw_weight = set.at("q_angle");
  o.cost.terminal_distance_weight = set.at("q_terminal_dist");
  o.cost.terminal_yaw_weight = set.at("q_terminal_angle");
  o.cost.collision_weight = set.at("collision_weight");
  o.max_acceleration = set.at("max_accel");
  o.max_deceleration = -set.at("min_accel").get<double>();
  o.reference_speed = set.at("reference_speed");
  o.localisation_less = set.at("localize_less");
  o.cost.outside_cost = o.localisation_less ? 10 : 100;
  o.own_of<published::ModelOptions>().straight_local_rollout = !o.localisation_less;
  return o;
}

}  // namespace slalom::vehicle::testing
