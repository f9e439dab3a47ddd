#include "slalom/maps/published.hpp"

#include "slalom/maps/local_cost_map.hpp"
#include "slalom/maps/reference_field.hpp"

namespace slalom::maps {

LocalCostMapOptions published_cost_map() {
  LocalCostMapOptions options{.body_inset = 0};
  options.published = {.half_open_inflation = true, .forget_points_outside = true};
  return options;
}

ReferenceFieldOptions published_reference_field() {
  return {.points_behind = 0};
}

}  // namespace slalom::maps
