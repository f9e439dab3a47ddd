#include "slalom/vehicle/localisation/localiser_options.hpp"

#include <stdexcept>
#include <string>

namespace slalom::vehicle {

void LocaliserOptions::validate() const {
  validate_options(*this, "localiser");
  if (particles.max_particles < particles.min_particles) {
    throw std::invalid_argument("localiser.max_particles: " + std::to_string(particles.max_particles) +
                                " must be at least min_particles, " +
                                std::to_string(particles.min_particles));
  }
  if (min_beams > beams) {
    throw std::invalid_argument("localiser.min_beams: " + std::to_string(min_beams) +
                                " must be at most beams, " + std::to_string(beams));
  }
  if (!(recovery.slow_rate < recovery.fast_rate)) {
    throw std::invalid_argument("localiser.slow_rate: " + std::to_string(recovery.slow_rate) +
                                " must be below fast_rate, " + std::to_string(recovery.fast_rate));
  }
}

}  // namespace slalom::vehicle
