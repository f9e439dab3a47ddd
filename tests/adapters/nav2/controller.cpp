// slalom_nav2::Controller implements nav2's interface of the minor version SLALOM_NAV2_MINOR.
#include "slalom_nav2/src/controller.hpp"

static_assert(!std::is_abstract_v<slalom_nav2::Controller>);
