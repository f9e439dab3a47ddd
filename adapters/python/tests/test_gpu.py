"""Controllers on a GPU: compared with those on the processor by running the kernels' source on the host."""

import copy
import pickle
import shutil
import subprocess
import sys

import numpy as np
import pytest

import slalom
import test_compiled
from test_compiled import PARTS, ROOT

pytestmark = pytest.mark.skipif(not shutil.which("c++") or not (slalom.gpu.FOLDER / "compile.cpp").exists(),
                                reason="no C++ compiler, or a build of the package without the GPU layer")
IMAGES = """#include "{header}"
#include "{root}/tests/gpu/emulation.hpp"
template <> std::span<const slalom::gpu::Image> slalom::gpu::images<{problem}>() {{
  static constexpr unsigned char code[1] = {{}};
  static const Image all[] = {{code}};
  fake_launch = &emulate<{problem}>;
  return all;
}}
"""


@pytest.fixture(scope="module")
def emulated(tmp_path_factory):
    """Compiles a problem with the kernels as loops on the host, behind a driver without a device."""
    folder = tmp_path_factory.mktemp("emulated")
    driver = folder / "libcuda.so.1"
    subprocess.run(["c++", "-shared", "-fPIC", f"-Wl,-soname,{driver.name}", ROOT / "tests/gpu/fake_cuda.cpp", "-o", driver],
                   check=True)

    def compile_for_host(header, problem, *_):
        header.with_name("images.cpp").write_text(IMAGES.format(header=header, root=ROOT, problem=problem))
        return header.with_name("images.cpp")

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        patch.setattr(slalom.gpu, "compile_kernels", compile_for_host)
        patch.setenv("CXX", f"c++ -Wl,--no-as-needed,-rpath,{folder} {driver}")
        yield lambda problem: slalom.compile(problem, gpu=[90])


def network(**parts):
    return slalom.MlpProblem(test_compiled.network(), **PARTS, discs=[(0.6, 0, 0.2)], disc_weight=5, **parts)


OPTIONS = {"horizon": 12, "samples": 200, "temperature": 1}
GUIDED = {**OPTIONS, "batches": 1, "noise_exponent": 0, "gradient_temperature": 1, "seed": 1}


@pytest.mark.parametrize("make", [lambda emulated: (slalom.Pendulum(length=1.5), emulated(slalom.Pendulum(length=1.5))),
                                  lambda emulated: (network(), network(gpu=90))], ids=["built-in", "network"])
def test_plans_are_those_of_the_processor(emulated, make):
    problem, compiled = make(emulated)
    bounds = {"input_min": -2, "input_max": 2}
    for name, options in ("Mppi", OPTIONS), ("SvgMppi", GUIDED):
        on_gpu = getattr(slalom.gpu, name)(compiled, **options, **bounds)
        processor = getattr(slalom, name)(problem, **options, **bounds)
        plan, expected = (each.solve([0.2, -0.3], elapsed=0.1) for each in (on_gpu, processor))
        assert plan.ok and type(plan) is type(expected) and on_gpu.fault == "" and on_gpu.method == processor.method
        assert np.allclose(plan.inputs, expected.inputs, atol=1e-3) and np.ptp(plan.inputs) > 0.01
        assert np.allclose(plan.states, expected.states, atol=1e-3) and plan.cost == pytest.approx(expected.cost, rel=1e-3)
        assert plan.collided_share == pytest.approx(expected.collided_share, abs=0.01)
        assert len(plan.samples) == len(plan.weights) == 0 and f"slalom.gpu.{name}(" in repr(on_gpu)


def test_parameters_and_states_of_controllers(emulated):
    controller = slalom.gpu.Mppi(emulated(slalom.Pendulum()), **OPTIONS)
    again = pickle.loads(pickle.dumps(controller))
    first = controller.solve([1, 0]).inputs.copy()
    assert isinstance(again, slalom.gpu.Mppi) and np.array_equal(again.solve([1, 0]).inputs, first)
    controller.reset(0)
    controller.problem.mass = 3
    controller.refresh()
    assert not np.array_equal(controller.solve([1, 0]).inputs, first)
    plans = slalom.solve_batch([controller, again], [[1, 0], [0.5, 0]], threads=2)
    assert all(plan.ok for plan in plans)
    with pytest.raises(RuntimeError, match="GPU: a controller is not copied; make another"):
        copy.copy(controller)


def test_what_a_gpu_lacks_is_refused(emulated, monkeypatch, tmp_path):
    with pytest.raises(ValueError, match="svg_mppi.temperature: 0 must be above 0 on a GPU"):
        slalom.gpu.SvgMppi(emulated(slalom.Pendulum()))
    callables = slalom.Problem(lambda x, u: x, lambda x, u: x[:, 0], states=1, inputs=1)
    for problem, text in (callables, r"callables of Python do not run .*docs/gpu.md"), (slalom.Pendulum(), r"has no code .*gpu=\[90\]"):
        with pytest.raises(ValueError, match=text):
            slalom.gpu.Mppi(problem, temperature=1)
    with pytest.raises(ValueError, match="slalom.Problem has no struct in C..; must be a built-in problem"):
        slalom.compile(callables, gpu=[90])
    monkeypatch.setenv("CUDA_PATH", str(tmp_path))
    with pytest.raises(slalom.CompileError, match=f"no CUDA toolkit in {tmp_path}: .*nvrtc.h and libnvrtc.so"):
        slalom.gpu.toolkit()


with_nvrtc = slalom.gpu.compile_kernels


def toolkit():
    try:
        return slalom.gpu.toolkit()
    except slalom.CompileError:
        return None


SETTINGS = """#include <slalom/slalom.hpp>
struct Settings {  // a name that slalom::gpu has, too
  template <class T> struct State { T x, y; };
  static constexpr int inputs = 1;
  template <class T> State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) const { return {x.x + u[0], x.y}; }
  template <class T> T stage_cost(const State<T>& x, const slalom::Input<T, 1>&) const { return x.x * x.x; }
};"""


@pytest.mark.skipif(not toolkit(), reason="no CUDA toolkit")
def test_nvrtc_compiles_the_struct_of_the_source_and_a_missing_device_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(slalom.gpu, "compile_kernels", with_nvrtc)
    problem = slalom.compile(SETTINGS, gpu=75)
    code = f"""import slalom
problem, options = slalom.CompiledProblem({problem.file!r}), {OPTIONS!r}
try:
    plans = [each(problem, **options).solve([0.2, -0.3]) for each in (slalom.gpu.Mppi, slalom.Mppi)]
    print(plans[0].status, abs(plans[0].inputs - plans[1].inputs).max() < 1e-3)
except slalom.gpu.DeviceError as error:
    print(error)"""
    done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True, check=True)
    absent = "GPU: no driver", "GPU: start of the driver", "GPU: first device", "GPU: loading the problem's code"
    assert done.stdout.startswith(absent) or done.stdout == "ok True\n"
