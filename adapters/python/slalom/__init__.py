"""Real-time sampling-based stochastic optimal control.

    import numpy as np, slalom

    controller = slalom.SvgMppi(slalom.Pendulum(), horizon=60, input_min=-5, input_max=5)
    plan = controller.solve([np.pi, 0.0], elapsed=0.02)
    if plan.ok:
        torque = plan.inputs[0]
"""

from . import _slalom
from ._slalom import *  # noqa: F401,F403
from ._slalom import __version__



class FewSamplesWarning(RuntimeWarning):
    """The effective sample size of a controller stays below 3, so its plans follow single samples."""


__all__ = [name for name in dir(_slalom) if not name.startswith("_")] + ["FewSamplesWarning", "__version__"]
