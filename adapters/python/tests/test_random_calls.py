"""Random calls of all that the stubs declare, most with wrong values, in a process of their own: none ends the
interpreter, takes more time or memory than its size needs, or raises an internal error. Random structs that are compiled:
one with a mistake is refused in Slalom's words, the others have plans that are finite and within bounds."""

import ast
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
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
        try:
            try:
                signal.setitimer(signal.ITIMER_REAL, SECONDS)
                made = call(*arguments, **named)
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)  # an alarm may come here, too
        except (*OWN, MemoryError, Interrupted) as raised:
            error = raised
        assert time.process_time() - begin < 4 * SECONDS, "takes too long, or signals do not end it"
        grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - held) / 1024
        assert grown < MEGABYTES and not isinstance(error, MemoryError), f"takes {grown} MB: {error!r}"
        assert not RAW.search(str(error)), repr(error)
        if type(made).__module__.startswith("slalom"):
            own = [*own[-30:], made]
            pool = [*pool[:size], *own]


# Names near that of an optional part, and functions with a mistake; what the compiler must say.
NEAR = {"terminalCost": "terminal_cost", "u_min": "input_min", "input_rate": "input_rate_max", "input_level": "input_levels",
        "lookUp": "look_up", "randomise": "randomize", "sampler": "sample", "h": "dt"}
WRONG = {"if (x.m0 > T(0)) return T(1);": "select", "const bool far = x.m0 > T(2); return T(far);": "select",
         "const double table[2] = {1, 2}; return T(table[int(x.m0)]);": "no index", "return std::exp(x.m0);": "not a double",
         "const auto both = slalom::sin_cos(x.m0);": "sin_cos writes"}
ONE, TWO = "sin cos tan exp log atan sqrt abs tanh cbrt floor square wrap_angle asin log1p".split(), "min max hypot atan2 pow fmod".split()


def expression(draw, names, depth=3):
    if depth == 0 or draw.random() < 0.3:
        return draw.choice([*names, *(f"T({each})" for each in "0 1 -1 0.1 3 1e-30 1e30 -1e6 1e-300".split())])
    a, b = (expression(draw, names, depth - 1) for _ in range(2))
    return draw.choice([f"slalom::{draw.choice(ONE)}({a})", f"slalom::{draw.choice(TWO)}({a}, {b})", f"({a} {draw.choice('+-*/')} {b})",
                        f"slalom::select({a} > {b}, {b}, {a})"])


def struct(draw):
    """(source, words of its mistake or None)."""
    states, inputs = [f"m{i}" for i in range(draw.randint(1, 4))], draw.randint(1, 3)
    seen, k, mistake = draw.choice(["", "", ", const T& seen"]), draw.choice(["", "", ", int k"]), draw.choice([None, None, *NEAR, *WRONG])
    names = ["x." + name for name in states]
    both = [*names, *["seen"] * bool(seen), *["T(k)"] * bool(k), *[f"u[{i}]" for i in range(inputs)]]
    every = f"const State<T>& x{seen}, [[maybe_unused]] const slalom::Input<T, {inputs}>& u{k}"
    cost = draw.choice(["{0}", "slalom::Cost<T>{{{0}, {1} > T(1)}}", "slalom::CostTerms<T, 2>{{{{{0}, {1}}}}}"])
    parts = {"State": f"template <class T> struct State {{ T {', '.join(states)}; }}", "inputs": f"static constexpr int inputs = {inputs}",
             "cost_names": 'static constexpr std::array cost_names{"one", "two"}',
             "step": f"template <class T> State<T> step({every}) const {{ return {{{', '.join(expression(draw, both) for _ in states)}}}; }}",
             "stage_cost": f"template <class T> auto stage_cost({every}) const {{ return {cost.format(*(expression(draw, both) for _ in '12'))}; }}"}
    if draw.random() < 0.6:
        parts |= {"input_min": f"double input_min = {draw.uniform(-3, 0)}", "input_max": f"double input_max = {draw.uniform(0, 3)}", **draw.choice([
            {}, {"input_levels": "double input_levels = 3"}, {"dt": "double dt = 0.1", "input_rate_max": "double input_rate_max = 2"}])}
    if seen:
        parts["look_up"] = f"template <class T> T look_up(const State<T>& x) const {{ return {expression(draw, names)}; }}"
    if mistake in WRONG or draw.random() < 0.7:
        parts["terminal_cost"] = (f"template <class T> T terminal_cost(const State<T>& x{seen}) const "
                                  f"{{ {mistake if mistake in WRONG else ''} return {expression(draw, names)}; }}")
    words = WRONG.get(mistake) if NEAR.get(mistake, "State") in parts else f"{mistake} would be ignored"
    parts |= {mistake: f"double {mistake} = 1"} if mistake in NEAR else {}
    return f"#include <array>\n#include <cmath>\nstruct Any {{ {'; '.join(parts.values())}; }};", words


def compile_structs(seed, count):
    for draw in map(random.Random, range(seed * count, (seed + 1) * count)):
        source, words = struct(draw)
        print(source, file=sys.stderr, flush=True)
        try:
            problem = slalom.compile(source, flags=["-O1", "-DSLALOM_ALLOW_UNOPTIMISED"])
        except slalom.CompileError as error:
            assert words and words in str(error), error
            continue
        assert not words, words
        controller = slalom.Controller(draw.choice(["mppi", "svg_mppi", "cem", "icem"]), problem, horizon=draw.randint(1, 20), samples=64)
        for _ in range(4):
            inputs = controller.solve([draw.choice([0, 1, -2, 1e-9, 1e30, draw.gauss(0, 3)]) for _ in range(problem.states)]).inputs
            assert np.isfinite(inputs).all() and (inputs >= problem.bounds[0]).all() and (inputs <= problem.bounds[1]).all(), inputs


@pytest.mark.parametrize("what, share", [("calls", 1), ("structs", 500)])
def test_random_calls_and_structs_are_answered_or_refused(what, share, tmp_path):
    if what == "structs" and not shutil.which("c++"):
        pytest.skip("no C++ compiler")
    count = int(os.environ.get("SLALOM_CALLS", 1500)) // share
    for seed in range(1, 3):
        done = subprocess.run([sys.executable, "-X", "faulthandler", __file__, what, str(seed), str(count)], capture_output=True, text=True,
                              env={**os.environ, "XDG_CACHE_HOME": str(tmp_path)})
        assert done.returncode == 0, f"seed {seed}: " + done.stderr[-2000:]


if __name__ == "__main__":
    {"calls": call_often, "structs": compile_structs}[sys.argv[1]](*map(int, sys.argv[2:]))
