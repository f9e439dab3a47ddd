"""The first plan of the installed Python package, and a map: without cars."""

import numpy as np
import slalom

plan = slalom.SvgMppi(slalom.CartPole(), horizon=60, input_min=-10, input_max=10).solve([0, 0, np.pi, 0], elapsed=0.02)
assert plan.ok
walls = slalom.signed_distance(slalom.OccupancyGrid(np.eye(20, dtype=bool), resolution=0.1))
assert walls.value(1.05, 1.05) < 0 < walls.value(0.1, 1.9)
print(plan)
