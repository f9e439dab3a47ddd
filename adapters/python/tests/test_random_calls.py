"""Random calls of all that the stubs declare, most with wrong values, in a process of their own: none ends the
interpreter, takes more time or memory than its size needs, or raises an internal error."""

import ast
import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import sys
import time

import numpy as np
import slalom

NUMBERS = [0, 1, -1, 2, 3, 7, 40, 0.05, 0.1, -0.5, 1e-9, 1e9, 1e300, float("nan"), float("inf"), -float("inf"), 2**31, 2**64,
           -2**63, True, None, "1", 1j]
WORDS = ["", "mppi", "svg_mppi", "wren", "default", "samples", "/dev/zero", "/tmp", "a\0b", "\udcff", "é" * 300, b"mppi", None, 3]
OWN = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RuntimeError, OSError, ImportError)
RAW = re.compile(r"std::|vector|basic_string|bad_alloc|_M_|map::at|Unable to cast")
SECONDS, MEGABYTES = 0.1, 200  # a call is interrupted after this; limits of growth


class Interrupted(BaseException):
    pass


def declared():
    """[(class or None, name, [(parameter, type)] or the type of an attribute that can be set)] of the stubs."""
    found = []
    for stub in pathlib.Path(slalom.__file__).parent.glob("*.pyi"):
        module = getattr(slalom, stub.stem)
        if module is None:  # built without vehicle and sim
            continue
        for node in ast.parse(stub.read_text()).body:
            owner = getattr(module, getattr(node, "name", ""), None)
            for each in node.body if isinstance(node, ast.ClassDef) else [node]:
                if not isinstance(each, ast.FunctionDef):
                    continue
                parameters = [(a.arg, ast.unparse(a.annotation)) for a in each.args.args + each.args.kwonlyargs if a.annotation]
                decorators = [ast.unparse(d) for d in each.decorator_list]
                if any(d.endswith(".setter") for d in decorators):
                    found.append((owner, each.name, parameters[0][1]))
                elif not decorators:
                    found.append((owner if isinstance(node, ast.ClassDef) else None, each.name, parameters))
    return found


def value_of(draw, kind, pool):
    if draw.random() < 0.1:
        return draw.choice([*NUMBERS, *WORDS, [], {}, np.zeros(3), object(), draw.choice(pool)])
    if "Array" in kind or "Sequence" in kind or "list" in kind:
        shape = tuple(draw.choice([0, 1, 1, 2, 3, 4, 7]) for _ in range(draw.choice([0, 1, 1, 2, 2, 3])))
        made = np.full(shape, draw.choice(NUMBERS[:17]), dtype=draw.choice([float, np.float32, np.int8, object]))
        return draw.choice([made, made.tolist(), made.T, [draw.choice(pool)]])
    if "Callable" in kind:
        return draw.choice([lambda *_: draw.choice(NUMBERS), lambda x, *_: np.asarray(x)[:, 0], None])
    if "dict" in kind:
        return {draw.choice(WORDS): draw.choice(NUMBERS) for _ in range(draw.randrange(3))}
    if kind == "str":
        return draw.choice(WORDS)
    if kind in ("float", "int", "bool") or "|" in kind:
        return draw.choice(NUMBERS)
    fitting = [each for each in pool if any(cls.__name__ in kind for cls in type(each).__mro__[:-1])]
    return draw.choice(fitting or pool)


def interrupt(*_):
    raise Interrupted


def call_often(seed, count):
    from test_package import objects

    pool, own, calls = objects(), [], declared()
    size, draw = len(pool), random.Random(seed)
    signal.signal(signal.SIGALRM, interrupt)
    resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
    for _ in range(count):
        owner, name, wanted = draw.choice(calls)
        having = [each for each in pool if owner and isinstance(each, owner)]
        if isinstance(wanted, str):
            arguments = (draw.choice(having or pool), name, value_of(draw, wanted, pool))
            call, named = setattr, {}
        else:
            call = getattr(draw.choice(having or pool), name, None) if owner and name != "__init__" else owner or getattr(slalom, name)
            named = {key: value_of(draw, kind, pool) for key, kind in wanted if draw.random() < 0.7}
            arguments = ()
        print(owner, name, *map(type, arguments), {k: v if isinstance(v, (int, float, str)) else type(v) for k, v in named.items()},
              file=sys.stderr, flush=True)
        held, begin, error, made = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time(), None, None
        signal.setitimer(signal.ITIMER_REAL, SECONDS)
        try:
            made = call(*arguments, **named)
        except (*OWN, MemoryError, Interrupted) as raised:
            error = raised
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
        assert time.process_time() - begin < 4 * SECONDS, "takes too long, or signals do not end it"
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - held) / 1024
        assert grown < MEGABYTES and not isinstance(error, MemoryError), f"takes {grown} MB: {error!r}"
        assert not RAW.search(str(error)), repr(error)
        if type(made).__module__.startswith("slalom"):
            own = [*own[-30:], made]
            pool = [*pool[:size], *own]


def test_random_calls_are_answered_or_refused():
    count = int(os.environ.get("SLALOM_CALLS", 1500))
    for seed in range(1, 3):
        done = subprocess.run([sys.executable, "-X", "faulthandler", __file__, str(seed), str(count)], capture_output=True, text=True)
        assert done.returncode == 0, f"seed {seed}: " + done.stderr[-2000:]


if __name__ == "__main__":
    call_often(*map(int, sys.argv[1:]))
