#include "slalom/vehicle/localisation/localiser_options.hpp"

#include <stdexcept>
#include <string>

namespace slalom::vehicle {

void LocaliserOptions::validate() const {
  validate_options(*this, "localiser");
  if (particles.most_particles < particles.least_particles) {
    throw std::invalid_argument("localiser.most_particles: " + std::to_string(particles.most_particles) +
                                " must be at least least_particles, " +
                                std::to_string(particles.least_particles));
  }
  if (least_beams > beams) {
    throw std::invalid_argument("localiser.least_beams: " + std::to_string(least_beams) +
                                " must be at most beams, " + std::to_string(beams));
  }
  if (!(recovery.slow_rate < recovery.fast_rate)) {
    throw std::invalid_argument("localiser.slow_rate: " + std::to_string(recovery.slow_rate) +
                                " must be below fast_rate, " + std::to_string(recovery.fast_rate));
  }
}

}  // namespace slalom::vehicle
