#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace slalom::testing {

/// Writes a small tree with the folders and file names of the authors' repository into `clone`: the course
/// wren as `berlin` and `spielberg`, and logs of two laps.
inline void write_paper_clone(const std::filesystem::path& clone, const std::filesystem::path& wren) {
  namespace fs = std::filesystem;
  for (const char* course : {"berlin", "spielberg"}) {
    const fs::path map = clone / "data/map" / course, path = clone / "data/reference_path" / course;
    fs::create_directories(map);
    fs::create_directories(path);
    for (const char* file : {"map.yaml", "map.png"}) fs::copy_file(wren / file, map / file);
    fs::copy_file(wren / "raceline.csv", path / "ego_ref_waypoint.csv");
    fs::copy_file(wren / "opp_ref_path.csv", path / "opp_ref_path.csv");
  }
  const auto log = [&](const std::string& name, bool obstacles) {
    const fs::path file = clone / "src/eval/log" / name;
    fs::create_directories(file.parent_path());
    std::ofstream stream(file);
    stream << "seed,success,collision,timeout,state_cost,collision_cost,input_error,mean_calculation_time,"
              "max_calculation_time,min_calculation_time\n";
    for (const int lap : {0, 1})
      stream << lap * (obstacles ? 10 : 5) << ",1," << (obstacles ? lap : 0) << ",0,0.2,0,0.4,11,40,9\n";
  };
  for (const bool obstacles : {false, true}) {
    const std::string scenario = obstacles ? "obstacle_avoidance/" : "path_tracking/";
    for (const char* method : {"forward_mppi(cov:0.025)", "forward_mppi(cov:0.05)", "forward_mppi(cov:0.075)",
                               "forward_mppi(cov:0.1)", "reverse_mppi", "sv_mpc", "svg_mppi"})
      log(scenario + method + ".csv", obstacles);
    for (const char* covariance :
         {"0.001", "0.005", "0.01", "0.015", "0.02", "0.025", "0.03", "0.05", "0.075", "0.1", "adaptive"})
      log("ablation_study/wo_cov_adaptation/" + scenario + "cov:" + covariance + ".csv", obstacles);
    // The authors have exchanged these two files.
    log("ablation_study/wo_nominal_solution/" + scenario + "wo_nominal_solution.csv", !obstacles);
    log("ablation_study/wo_nominal_solution/" + scenario + "w_nominal_solution.csv", obstacles);
  }
}

}  // namespace slalom::testing
