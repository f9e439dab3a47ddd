"""The page of a controller: a client of its WebSocket gets the drive of the controller, and its commands act."""

import base64
import contextlib
import json
import os
import socket
import struct
import subprocess
import sys
import time
import urllib.parse
import urllib.request

import numpy as np
import pytest
import slalom

TREE = [4.0, 0.0]


def dynamics(x, u):
    return np.stack([x[:, 0] + 0.1 * u[:, 0] * np.cos(x[:, 2]), x[:, 1] + 0.1 * u[:, 0] * np.sin(x[:, 2]),
                     x[:, 2] + 0.1 * u[:, 1]]).T.astype(x.dtype)


def cost(x, u):
    near = np.hypot(x[:, 0] - TREE[0], x[:, 1] - TREE[1]) < 1
    return {"goal": np.hypot(x[:, 0] - 8, x[:, 1]), "tree": 100.0 * near}, near


def garden(cost=cost, **limits):
    problem = slalom.Problem(dynamics, cost, states=3, inputs=2, dt=0.1, **limits)
    return slalom.SvgMppi(problem, horizon=20, samples=256, input_min=[0, -2], input_max=[1.5, 2])


class Client:
    """Speaks as much of the WebSocket protocol as these tests need."""

    def __init__(self, address):
        url = urllib.parse.urlparse(address)
        self.socket = socket.create_connection((url.hostname, url.port), timeout=60)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET /ws HTTP/1.1\r\nHost: {url.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Origin: http://{url.netloc}\r\nSec-WebSocket-Key: {key}\r\n"
                            "Sec-WebSocket-Version: 13\r\n\r\n".encode())
        self.file = self.socket.makefile("rb")
        assert b"101" in self.file.readline()
        while self.file.readline() != b"\r\n":
            pass

    def read(self):
        """The next message: text as an object, the scalars of a frame as an array."""
        kind, length = self.file.read(2)
        if length == 126:
            length = struct.unpack(">H", self.file.read(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self.file.read(8))[0]
        content = self.file.read(length)
        if kind & 15 == 1:
            return json.loads(content)
        self.frame = content
        return np.frombuffer(content, "<f8", struct.unpack_from("<I", content, 8)[0] // 8, 12)

    def find(self, wanted):
        deadline = time.monotonic() + 60
        while time.monotonic() < deadline:
            message = self.read()
            if wanted(message):
                return message
        raise TimeoutError

    def block(self, kind):
        """The payload of a block of the last frame."""
        at, found, length = 4, 0, 0
        while found != kind:
            found, length = struct.unpack_from("<HxxI", self.frame, at)
            at += 8 + (length + 3) // 4 * 4
        return self.frame[at - (length + 3) // 4 * 4:]

    def text(self, kind):
        return self.find(lambda m: isinstance(m, dict) and m["type"] == kind)

    def send(self, **command):
        content = json.dumps(command).encode()
        assert len(content) < 126
        self.socket.sendall(bytes([0x81, 0x80 | len(content), 0, 0, 0, 0]) + content)


@contextlib.contextmanager
def shown(controller, **drawing):
    """A client of the page that shows a controller."""
    page = slalom.show(controller, [0, 0, 0], port=0, block=False, browser=False, **drawing)
    try:
        yield Client(page.address)
    finally:
        page.close()


@pytest.mark.parametrize("make", [garden, lambda: slalom.SvgMppi(slalom.DifferentialDrive(), horizon=20, samples=256,
                                                                   input_min=[0, -2], input_max=[1.5, 2])])
def test_a_page_shows_the_drive_of_a_controller(make):
    moved = []
    with shown(make(), heading=2, shapes=lambda problem: [(*TREE, 1), [[2, 2], [3, 2], [3, 3]]],
               move=lambda problem, shape, x, y: moved.append((shape, x, y))) as client:
        names = client.text("hello")["scalars"]
        frame = client.find(lambda m: isinstance(m, np.ndarray) and m[0] >= 5)
        # The same drive without a page.
        controller, x = make(), np.zeros(3)
        for k in range(int(frame[0])):
            x = controller.problem.step(x, controller.solve(x, elapsed=0.1 if k else 0).inputs[0])
        assert np.allclose([frame[names.index(name)] for name in ("x", "y", "yaw")], x)
        client.send(do="pause")
        client.send(do="set", key="svg_mppi.samples", value="100")
        samples = names.index("samples")
        client.find(lambda m: isinstance(m, np.ndarray) and m[samples] < frame[samples])
        client.send(do="move", body=1, x=3, y=1, id=7)
        assert client.text("done")["id"] == 7 and set(moved) == {(0, 3.0, 1.0)}
        client.send(do="set", key="svg_mppi.samples", value="0", id=8)
        assert "must be in" in client.text("error")["message"]


def test_a_plan_on_the_page_keeps_the_rates_of_the_problem():
    make = lambda: garden(input_rate_max=[2, 3])
    with shown(make(), heading=2) as client:
        tick = int(client.find(lambda m: isinstance(m, np.ndarray))[0])
        points, *middle = struct.unpack_from("<Idd", client.block(7))
        places = np.frombuffer(client.block(7), "<f4", 6 * points, 20).reshape(points, 6)[:, :2] + middle
        controller, x = make(), np.zeros(3)
        for k in range(tick + 1):
            plan = controller.solve(x, elapsed=0.1 if k else 0)
            x = controller.problem.step(x, plan.inputs[0])
        assert np.allclose(places, plan.states[:, :2], atol=1e-5)


def test_goals_a_clock_and_a_second_method_are_shown():
    times = []
    with shown(garden(), goals=[(4, 1, 0.5)], clock=lambda problem, time: times.append(time), against="mppi") as client:
        assert client.text("state")["ghost"] == "mppi"
        client.find(lambda m: isinstance(m, np.ndarray) and m[0] >= 3)
        number, kind, _, x, y = struct.unpack_from("<HBBff", client.block(8), 28)
    assert (number, kind, x, y) == (1, 6, 4, 1)
    assert np.allclose(sorted(set(np.round(times, 6)))[:4], [0, 0.1, 0.2, 0.3])


def test_a_cost_whose_terms_change_is_an_error():
    view = slalom._slalom._View(garden(lambda x, u: {"far" if x[:, 0].max() > 0.01 else "near": x[:, 0]}), [0, 0, 0], port=0)
    _client = Client(view.address)
    with pytest.raises(ValueError, match="the term 'far' is not among those"):
        for _ in range(100):
            view.turn()


def test_a_notebook_shows_the_page_inside():
    page = slalom.show(garden(), [0, 0, 0], port=0, block=False, browser=False)
    policy = urllib.request.urlopen(page.address).headers["Content-Security-Policy"]
    page.close()
    assert page.address in page._repr_html_() and policy.startswith("frame-ancestors http://localhost:* ")


def test_a_program_ends_while_a_page_is_open():
    program = ("import slalom, time; slalom.show(slalom.SvgMppi(slalom.DifferentialDrive()), [0, 0, 0], port=0,"
               " block=False, browser=False); time.sleep(0.2)")
    assert subprocess.run([sys.executable, "-c", program], timeout=60).returncode == 0


def test_wrong_drawings_are_errors():
    for drawing, message in [({"start": [0, 0]}, "start: has 2 values, must have 3"),
                             ({"start": [0, 0, 0], "heading": 3}, "3 must be an index of a state"),
                             ({"start": [0, 0, 0], "state_names": ["x"]}, "has 1 names, must have 3"),
                             ({"start": [0, 0, 0], "host": "0.0.0.0"}, "token: must be given"),
                             ({"start": [0, 0, 0], "against": "mpc"}, "mpc")]:
        with pytest.raises(ValueError, match=message):
            slalom.show(garden(), drawing.pop("start"), port=0, block=False, browser=False, **drawing)
