#include "logic/planner_core.hpp"

#include "slalom/evaluation/result_folder.hpp"
#include "slalom/evaluation/statistics.hpp"

namespace slalom::nodes {
namespace {

constexpr double patience = 1.6;  // control periods without a command, after which the inputs are checked
constexpr double wait_for_pose = 0.8;  // control periods that a scan waits for the transforms of its time

OthersFrom from_name(const std::string& name) {
  for (const OthersFrom each : {OthersFrom::none, OthersFrom::scan, OthersFrom::topic})
    if (name == enum_names(each)[static_cast<int>(each)]) return each;
  throw std::invalid_argument("others: '" + name + "' must be one of none, scan, topic");
}

/// Whether the end of a path is near its start.
bool is_closed(const PlannerCore::Path& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i)
    length += std::hypot(path[i].x - path[i - 1].x, path[i].y - path[i - 1].y);
  const double gap = std::hypot(path.front().x - path.back().x, path.front().y - path.back().y);
  return gap < 5 * length / static_cast<double>(path.size());
}

}  // namespace

PlannerCore::PlannerCore(const Settings& settings, Clocks clocks, Transforms transforms, Outputs outputs)
    : clocks_(std::move(clocks)),
      transforms_(std::move(transforms)),
      outputs_(std::move(outputs)),
      settings_(settings),
      watch_(settings.limits, clocks_),
      log_(clocks_.steady, outputs_.warn),
      configuration_(load_configuration(settings.configuration)),
      others_from_(from_name(settings.others)) {
  for (auto* each : {&heard_points_, &points_, &points_of_car_}) each->reserve(4096);
  solver_options(settings.method);  // throws on an unknown method
}

vehicle::Planner PlannerCore::make_planner(const vehicle::Configuration& with, const Path& along) const {
  return {with.planner, vehicle::make_vehicle_model(with.vehicle), along,
          vehicle::make_solver(with, settings_.method, 1)};
}

std::vector<NamedOption> PlannerCore::options() const {
  std::vector<NamedOption> all;
  for (const vehicle::Section& section : vehicle::list_sections(configuration_)) {
    if (section.name != "vehicle" && section.name != "planner" && section.name != settings_.method) continue;
    for (const OptionEntry& entry : section.options)
      all.push_back({section.name + "." + entry.declaration.name, entry});
  }
  return all;
}

void PlannerCore::change(const Changes& changes) {
  vehicle::Configuration changed = configuration_;
  for (const auto& [name, text] : changes) vehicle::set_option(changed, name, text, settings_.method);
  if (planner_) planner_ = make_planner(changed, path_);
  page_.reset();
  configuration_ = std::move(changed);
}

void PlannerCore::save(const std::string& file) const {
  evaluation::replace_file(file, vehicle::to_yaml(configuration_));
}

void PlannerCore::use_course() {
  if (settings_.course.empty()) return;
  const vehicle::Course course = load_course(settings_.course);
  map_ = course.map;
  Path path;
  for (const vehicle::Waypoint& w : course.waypoints) path.push_back({w.x, w.y, w.yaw, w.speed});
  use_path(path, course.closed);
}

void PlannerCore::use_path(const Path& path, bool closed) {
  planner_ = make_planner(configuration_, path);
  others_watch_.reset();
  if (others_from_ != OthersFrom::none)
    others_watch_.emplace(map_ ? tracking::ObjectTracker(*map_) : tracking::ObjectTracker(),
                          tracking::Predictor(path));
  path_ = path;
  page_.reset();
  laps_.reset();
  if (closed) {
    std::vector<maps::Point> points;
    for (const maps::ReferencePoint& point : path) points.push_back({point.x, point.y});
    const sim::LapPath around(std::move(points));
    laps_.emplace(Laps{around, sim::LapTimer(around)});
  }
  laps_to_drive_ = 0;
  outputs_.path(path, closed);
}

/// A scan waits a little for the transforms of its time, which arrive on another topic.
bool PlannerCore::scan_is_due() const {
  if (!new_scan_) return false;
  return clocks_.steady() - scan_heard_ > wait_for_pose * configuration_.planner.control_period ||
         transforms_.knows(scan_stamp_);
}

void PlannerCore::start_anew() {
  transforms_.forget();
  scan_stamp_ = used_ = odometry_stamp_ = 0;
  forget_inputs();
  new_scan_ = false;
  watch_.forget();
}

void PlannerCore::hear_scan(Stamp stamp, const std::string& frame, const maps::LaserScanView& scan,
                            double angle_max) {
  if (!watch_.accepts("scan", in_seconds(stamp), in_seconds(scan_stamp_))) return;
  if (!count_fits(scan, angle_max))
    return watch_.report("the number of ranges of the scan does not match its angles");
  if (used_ != 0 && in_seconds(stamp - used_) < settings_.scan_interval) return;
  ranges_.assign(scan.ranges.begin(), scan.ranges.end());
  scan_ = scan;
  scan_.ranges = ranges_;
  if (scan_frame_ != frame) scan_frame_ = frame;
  scan_stamp_ = stamp;
  scan_heard_ = clocks_.steady();
  new_scan_ = true;
}

void PlannerCore::hear_odometry(Stamp stamp, double speed) {
  if (!watch_.accepts("odometry", in_seconds(stamp), in_seconds(odometry_stamp_))) return;
  if (!std::isfinite(speed)) return watch_.report("the speed of the odometry is not finite");
  odometry_stamp_ = stamp;
  speed_ = speed;
}

void PlannerCore::hear_other_command(const std::string& name) {
  watch_.report("another node commands the car" + (name.empty() ? "" : ": " + name));
}

void PlannerCore::hear_path(const Path& path) {
  try {
    if (path.size() < 3) throw std::invalid_argument("fewer than 3");
    use_path(path, is_closed(path));
  } catch (const std::exception& error) {
    log_(std::string("waypoints: ") + error.what() + "; ignored");
  }
}

void PlannerCore::drive_laps(int laps) {
  if (laps < 0) throw std::invalid_argument("laps: " + std::to_string(laps) + " must be at least 0");
  if (!laps_) throw std::invalid_argument("laps: there is no closed path");
  laps_->started = false;
  laps_to_drive_ = laps;
}

int PlannerCore::laps() const {
  return laps_ && laps_->started ? laps_->timer.laps() : 0;
}

void PlannerCore::count_laps(const maps::Pose& pose) {
  if (!laps_) return;
  if (std::exchange(laps_->started, true))
    laps_->timer.update(laps_->path, {pose.x, pose.y}, in_seconds(scan_stamp_));
  else
    laps_->timer.reset(laps_->path, pose, in_seconds(scan_stamp_));
}

/// The pose of the rear axle at the time of the scan. Returns false and reports the fault if it is unknown.
bool PlannerCore::find_pose(maps::Pose& pose) {
  try {
    pose = moved_ahead(transforms_.pose(scan_stamp_), settings_.rear_axle);
    place_laser();
  } catch (const std::exception& error) {
    watch_.report_consequence(std::string("tf: ") + error.what());
    return false;
  }
  return watch_.moves_like_a_car(pose, in_seconds(scan_stamp_));
}

void PlannerCore::place_laser() {
  const Mount mount = transforms_.mount(scan_frame_);
  if (!mount.upright()) throw std::runtime_error("the laser " + scan_frame_ + " must be level and upright");
  maps::Pose laser = mount.planar();
  laser.x -= settings_.rear_axle;
  const vehicle::PlannerOptions& options = configuration_.planner;
  if (same_place(laser, {options.laser_x, options.laser_y, options.laser_yaw})) return;
  change({{"planner.laser_x", std::to_string(laser.x)},
          {"planner.laser_y", std::to_string(laser.y)},
          {"planner.laser_yaw", std::to_string(laser.yaw)}});
  outputs_.inform("the laser is at x " + std::to_string(laser.x) + " m, y " + std::to_string(laser.y) +
                  " m, yaw " + std::to_string(laser.yaw) + " rad by tf");
}

void PlannerCore::tick() {
  if (!watch_.clock_runs()) start_anew();
  const double idle = clocks_.steady() - sent_;
  if (scan_is_due() || idle > patience * configuration_.planner.control_period) plan();
  log_.flush();
}

void PlannerCore::plan() {
  const bool scanned = std::exchange(new_scan_, false);
  maps::Pose pose;
  const bool well = planner_ ? watch_.fresh("scan", in_seconds(scan_stamp_)) &&
                                   watch_.fresh("odometry", in_seconds(odometry_stamp_)) && has_fresh_inputs()
                             : (watch_.report_consequence("no waypoints yet"), false);
  const bool placed = well && (!scanned || find_pose(pose));
  const std::string fault = watch_.fault();
  if (!fault.empty()) return stop(fault);
  if (!placed) return stop("input");
  if (goal_speed_ == 0.0) return stop("goal speed is 0");
  if (!scanned) return;  // the scan is slightly late; the last command remains valid
  count_laps(pose);
  if (laps_to_drive_ > 0 && laps() >= laps_to_drive_) return stop("all laps are driven");
  vehicle::PlannerInput input{.scan = scan_, .odometry = {.pose = pose, .speed = speed_}};
  complete(input);
  const vehicle::PlannerOutput& out = planner_->update(input);
  used_ = scan_stamp_;
  known_ = out.parameters;
  slip_ = out.slip_estimate;
  ++second_.plans;
  second_.late += out.tick_time > configuration_.planner.control_period;
  second_.slowest = std::max(second_.slowest, out.tick_time);
  second_.corrections += out.corrections;
  second_.min_samples = std::min(second_.min_samples, out.solve ? out.solve->effective_sample_size : 0);
  if (!has_plan(out.status)) {
    second_.why = vehicle::name(out.status);
    log_("braking: " + second_.why);
  }
  last_steer_ = out.command.steer;
  send(out.command);
  latency_.add(clocks_.now() - in_seconds(scan_stamp_));
  outputs_.plan(out, scan_stamp_);
  show(input, out);
}

void PlannerCore::show(const vehicle::PlannerInput& input, const vehicle::PlannerOutput& out) {
  if (settings_.view_port == 0) return;
  try {
    if (!page_) {
      page_.emplace(static_cast<std::uint16_t>(settings_.view_port), configuration_, *planner_, input.scan,
                    view::SubjectFacts{.map = map_, .course = path_, .is_closed = laps_.has_value()});
      outputs_.inform("the live view is at " + page_->address());
    }
  } catch (const std::exception& error) {
    settings_.view_port = 0;
    return log_(std::string("view_port: ") + error.what());
  }
  page_->show(*planner_, input, out);
}

void PlannerCore::stop(const std::string& why) {
  ++second_.stops;
  second_.why = why;
  last_stop_ = why + ", at " + seconds(clocks_.now());
  log_("stopping: " + why);
  send({last_steer_, 0});
}

void PlannerCore::halt() {
  send({last_steer_, 0});
  start_anew();
}

void PlannerCore::send(const Command& command) {
  sent_ = clocks_.steady();
  sent_lately_[next_sent_++ % sent_lately_.size()] = command;
  outputs_.drive(command);
}

Report PlannerCore::report() {
  Report r{.about = "plans"};
  r.add("plans", second_.plans);
  r.add("stops", second_.stops);
  r.add("deadlines missed", second_.late);
  r.add("values corrected", second_.corrections);
  r.add("slowest update, ms", 1e3 * second_.slowest);
  r.add("deadline, ms", 1e3 * configuration_.planner.control_period);
  if (!latency_.values().empty()) {
    r.add("latency from scan to command, p50, ms", 1e3 * evaluation::percentile(latency_.values(), 0.5));
    r.add("latency from scan to command, p99, ms", 1e3 * evaluation::percentile(latency_.values(), 0.99));
  }
  if (laps_) r.add("laps", laps());
  if (known_.friction > 0) {
    r.add("friction", known_.friction);
    r.add("friction, standard deviation", known_.friction_deviation);
    r.add("friction that plans rely on", known_.cautious_friction);
    r.add("confidence of the friction", known_.confidence);
    r.add("steering gain", known_.steering_gain);
    r.add("steering offset, rad", known_.steering_offset);
    r.add("steering delay, ms", 1e3 * known_.delay);
    r.add("slip angle, rad", slip_);
  }
  if (others_watch_) r.add("other cars", others_);
  if (goal_speed_) r.add("goal speed, m/s", *goal_speed_);
  if (points_stamp_ != 0) r.add("obstacle points", points_.size());
  if (obeyed()) r.add("commands", "of somebody else");
  if (!last_stop_.empty()) r.add("last stop", last_stop_);
  if (second_.plans > 0) r.add("least effective sample size", second_.min_samples);
  r.message = second_.why.empty() ? "driving" : second_.why;
  r.level = second_.stops > 0 || second_.plans == 0    ? Level::error
            : second_.late > 0 || !second_.why.empty() ? Level::warning
                                                       : Level::ok;
  second_ = {};
  return r;
}

}  // namespace slalom::nodes
