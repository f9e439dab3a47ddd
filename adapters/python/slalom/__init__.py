"""Real-time sampling-based stochastic optimal control.

    import numpy as np, slalom

    controller = slalom.SvgMppi(slalom.Pendulum(), horizon=60, input_min=-5, input_max=5)
    drive = slalom.run(slalom.Pendulum(), controller, [np.pi, 0.0], steps=300)
    drive.states, drive.inputs, drive.costs, drive.times
"""

import importlib
import importlib.util

from . import _slalom, display, plot
display.add_methods(_slalom)
display.install(_slalom)
from ._slalom import *  # noqa: E402,F401,F403
from ._slalom import __version__  # noqa: E402
from .closed_loop import Run, run  # noqa: E402
from .compiler import CompileError, compile  # noqa: E402
from .derivatives import Feedback, Linearization, linearize  # noqa: E402
from .network import MlpProblem  # noqa: E402
from .show import show  # noqa: E402
from . import study  # noqa: E402

if importlib.util.find_spec("slalom._driving"):
    from . import _driving
    display.add_signatures(_driving)
    from ._driving import *  # noqa: F401,F403
else:  # built without the layers for cars
    _driving = None  # type: ignore[assignment]

_DRIVING = ("Costmap", "Course", "Footprint", "Navigator", "ObjectTracker", "Planner", "PredictedObstacle", "Predictor", "TrackedObject",
            "World", "courses", "drive_lap", "drop_readings_of", "plan_path")


class SymptomWarning(RuntimeWarning):
    """A likely reason for poor plans: a `Plan.symptom` that has stayed for 20 solves, costs that are nan or differ for the
    same arguments, or an `elapsed` beyond the horizon."""


def __getattr__(name: str) -> object:
    if name == "tune":  # needs Optuna
        tuner = importlib.import_module("slalom.tuner")
        display.describe_all({name: tuner.tune})
        return tuner.tune
    if name in _DRIVING:
        raise AttributeError(f"slalom.{name} is not in this build, which has no cars, robots, courses and simulator: install it "
                             "with SLALOM_DRIVING=1 pip install, or build all layers with CMake")
    raise AttributeError(f"module 'slalom' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*__all__, "compile", "gpu", "plot", "study", "tune"])


from . import gpu  # noqa: E402  the signatures of its classes are those of the compiled ones
for _module in filter(None, (_slalom, _driving)):
    display.set_pickles(_module)
__all__ = [name for module in (_slalom, _driving) if module for name in dir(module) if not name.startswith("_")]
__all__ += ["CompileError", "Feedback", "Linearization", "MlpProblem", "Run", "SymptomWarning", "__version__", "linearize", "run", "show"]
display.describe_all({name: globals()[name] for name in __all__})
display.describe_all(vars(plot), plot.__name__)
