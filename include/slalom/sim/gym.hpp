#pragma once

/// Switches that only reproduce f1tenth_gym, the simulator of the paper's experiments: its deviations from
/// the physics and geometry that this simulator computes. Each options struct of the layer that has such
/// switches holds them in a member `gym`; all are off by default. `all()` turns on every switch of a struct.
/// `WorldOptions::gym_compatible()` turns on those of a world, and sets the other options in which its world
/// differs.
namespace slalom::sim {

/// Deviations of the equations of motion.
struct GymDynamics {
  /// Below 0.5 m/s the car moves along its axis, the slip angle does not change, and the yaw rate of the
  /// state differs from the rate at which the yaw changes.
  bool low_speed = false;
  /// The last move towards the steering's limit may pass it by steer_rate_max * time step.
  bool steer_overshoot = false;
  /// In reverse the tyres push the wrong way, and yaw rate and slip grow without bound.
  bool reverse = false;

  static constexpr GymDynamics all() { return {true, true, true}; }  ///< all on
};

/// Deviations of the low-level control.
struct GymActuation {
  /// The steering moves at full rate or not at all, so that it chatters about its target.
  bool steering = false;
  /// The gains of the speed control follow from the limits of speed. At standstill and in reverse they are a
  /// fifth of those forwards.
  bool gains = false;

  static constexpr GymActuation all() { return {true, true}; }  ///< all on
};

/// Deviations of the car as a whole.
struct GymPlant {
  /// The yaw is brought to [0, 2 pi] by at most one turn per step; elsewhere it lies in [-pi, pi].
  bool yaw = false;

  static constexpr GymPlant all() { return {true}; }  ///< on
};

/// Deviations of the laser scanner.
struct GymLidar {
  /// A beam walks from cell to cell by the cells' distances to the nearest wall, centre to centre, until it
  /// is in a wall cell, so that ranges are up to a cell off; outside the map it reads the last cell's
  /// distance.
  bool ranges = false;
  /// Directions are taken from a table of 2000 (step 2 pi / 1999), up to 0.003 rad off.
  bool directions = false;
  /// Noise is that of numpy's default_rng(12345), seeded again at each reset, and the same for every car. It
  /// is added after ranges are limited to range_max and before other cars are scanned, so ranges to them have
  /// no noise.
  bool noise = false;
  /// Only the beams between those nearest to a car's corners are tested for it.
  bool window = false;

  static constexpr GymLidar all() { return {true, true, true, true}; }  ///< all on
};

/// Deviations of the world.
struct GymWorld {
  /// Walls are hit by TimeToCollision instead of by the car's outline.
  bool wall_collision = false;
  /// reset() makes one step with zero commands.
  bool reset_step = false;
  /// A car that hits a wall stays at its new position, and its speed, yaw, yaw rate and slip become 0, so it
  /// turns to +x at once. Replaces WorldOptions::wall_response.
  bool wall_stop = false;

  static constexpr GymWorld all() { return {true, true, true}; }  ///< all on
};

/// Deviations of the pure pursuit driver.
struct GymPurePursuit {
  /// The nearest point is searched on an open path and the target on a closed one, whose segments are shifted
  /// by 1e-6 m at their ends. The target is the start of the segment found, or of the nearest segment if the
  /// path is further away than the lookahead. The steering is that for an arc with the fixed lookahead as its
  /// chord, and is not bounded.
  bool waypoint_search = false;

  static constexpr GymPurePursuit all() { return {true}; }  ///< on
};

}  // namespace slalom::sim
