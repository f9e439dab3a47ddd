#pragma once

/// What exists only to reproduce f1tenth_gym, the simulator of the paper's experiments: switches for its
/// deviations from the physics and geometry that this simulator computes. Each options struct of the layer
/// that has such switches holds them in a member `gym`; all are off by default. `all()` turns on
/// every switch of a struct, and `WorldOptions::gym_compatible()` sets those of a world together.
namespace slalom::sim {

/// Deviations of the equations of motion.
struct GymDynamics {
  /// Below 0.5 m/s the car moves along its axis, the slip stays frozen and the yaw rate is integrated beside
  /// the yaw that is really driven.
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
  /// Gains follow from the limits of speed and are a fifth of the others at standstill and in reverse.
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
  /// Noise is numpy's default_rng(12345), begun anew at each reset, the same for every car; it is added after
  /// the cut at range_max and before other cars are seen, which stay without noise.
  bool noise = false;
  /// A car is looked for only in the beams between those nearest to its corners.
  bool window = false;

  static constexpr GymLidar all() { return {true, true, true, true}; }  ///< all on
};

/// Deviations of the world.
struct GymWorld {
  /// Walls are hit by TimeToCollision instead of by the car's outline.
  bool wall_collision = false;
  /// reset() makes one step with zero commands.
  bool reset_step = false;
  /// A car that hits a wall stays where it drove to, and its speed, yaw, yaw rate and slip become 0, so that
  /// it turns to +x at once. Replaces WorldOptions::wall_response.
  bool wall_stop = false;

  static constexpr GymWorld all() { return {true, true, true}; }  ///< all on
};

/// Deviations of the pure pursuit driver.
struct GymPurePursuit {
  /// The path is open for the nearest point and closed only for the search ahead, whose segments end 1e-6 m
  /// off; what is aimed at is the start of the segment found, or of the nearest one with the arc for the
  /// fixed lookahead; and steering is not bounded.
  bool waypoint_search = false;

  static constexpr GymPurePursuit all() { return {true}; }  ///< on
};

}  // namespace slalom::sim
