"""The page in the browser that shows a controller of your own problem."""

from __future__ import annotations

import atexit
import threading
import webbrowser
from typing import Any

from . import _slalom


class Showing:
    """A page that a thread serves. `address` is where; `close` ends it. In a notebook it shows itself."""

    def __init__(self, view: Any) -> None:
        self.address: str = view.address
        self._open = True
        self._thread = threading.Thread(target=self._run, args=(view,), daemon=True)
        self._thread.start()
        atexit.register(self.close)  # a thread must not run Python code while Python ends

    def _run(self, view: Any) -> None:
        while self._open:
            view.turn()

    def close(self) -> None:
        """Ends the page."""
        self._open = False
        self._thread.join()
        atexit.unregister(self.close)

    def __repr__(self) -> str:
        return f"Showing({self.address})"

    def _repr_html_(self) -> str:
        return f'<iframe src="{self.address}" width="100%" height="640" style="border:0"></iframe>'


def show(controller: Any, start: Any, *, block: bool = True, browser: bool = True, **drawing: Any) -> Showing | None:
    """Shows on a page in the browser how `controller` drives its problem from the state `start`: samples, guides and
    plan, charts of states, inputs and costs, all options, pause and the past. `controller` itself does not change.

    drawing:
      x, y, heading   indices of the states with position (m) and heading (rad); by default 0, 1, None
      pose            instead: function of states (n, states), returns places (n, 2), or (n, 3) with the yaw
      length, width   size of the body, m; 0: a dot
      figure          function of a state, returns lines (n, 2) that show the body
      shapes          list, or function of the problem that returns it: discs (x, y, radius), boxes (x, y, yaw, length,
                      width) and polygons (n, 2)
      goals           list, or function of the problem that returns it: discs (x, y, radius) to reach
      move            function (problem, index of a shape, x, y): moves a shape that is dragged; goals follow the shapes
      clock           function (problem, time): the problem at a time (s) since the start, before each plan
      against         a second method, such as "mppi", which drives beside the first from the start
      map             OccupancyGrid, drawn under all else
      plant           function of state and input, returns the next state of the real system; by default the problem
      state_names, input_names   such as "speed, m/s"
      title, host, port, token   name of the problem; where the page is served: 127.0.0.1, 8400

    Blocks until Ctrl-C; with `block=False` returns at once, while a thread serves the page. `browser`: opens it."""
    if not hasattr(_slalom, "_View"):
        raise RuntimeError("slalom.show is not in this build: install libboost-dev and nlohmann-json3-dev and build again")
    view = getattr(_slalom, "_View")(controller, start, **drawing)
    if browser:
        webbrowser.open(view.address)
    if not block:
        return Showing(view)
    print(f"{view.address}\nopen this address in a browser; Ctrl-C ends", flush=True)
    try:
        while True:
            view.turn()
    except KeyboardInterrupt:
        return None
