"""The tuner finds better options, prunes what is worse, goes on where it was stopped, and says how sure it is."""

import json
import subprocess
import sys

import pytest
import slalom
from slalom import study
from test_study import calls, noted  # noqa: F401  a fixture

optuna = pytest.importorskip("optuna")
pytest.importorskip("sklearn")
SPACE = {"x": (-3.0, 3.0), "y": (1, 100), "kind": ["a", "b", "none"]}


def bowl(seed, x=2.0, y=1, kind="a"):
    """Least at x = 0.5 and kind b; seeds differ by more than values."""
    noted(seed)
    if kind == "none":
        raise ValueError("kind: must be a or b")
    return (x - 0.5) ** 2 + (0.3 if kind == "a" else 0) + 1e-3 * y + seed * 7919 % 101 + 0.01 * (seed * x % 1)


def test_better_values_are_found_and_what_was_driven_is_kept(calls, tmp_path):  # noqa: F811
    made = study.Function(tmp_path / "t", function=bowl, seeds=32, seed=5)
    found = slalom.tune(made, SPACE, trials=25, confirm=20, quiet=True)
    assert abs(found["values"]["x"] - 0.5) < 0.7 and found["interval"][1] < 0 and found["after"] < found["before"] - 1
    assert list(found["importances"])[0] == "x" and 15 < found["trials"] < 25, "values that are refused are no trials"
    trials = optuna.load_study(study_name="slalom", storage=f"sqlite:///{tmp_path}/t/optuna.db")
    pruned = [each for each in trials.trials if each.state == optuna.trial.TrialState.PRUNED and each.value]
    assert pruned and all(len(each.user_attrs["scores"]) < 32 for each in pruned[:3])
    text = found["file"].read_text()
    assert f"{found['trials']} trials of up to 32 runs" in text and "(95 %): better." in text and "\nx: " in text and "\nkind: b\n" in text
    assert len(set(calls.read_text().split())) == 32 + 20, "the confirmation has seeds of its own"
    driven = calls.read_text()
    assert slalom.tune(made, SPACE, trials=25, confirm=20, quiet=True) == found and calls.read_text() == driven
    killed = trials.ask({"x": optuna.distributions.FloatDistribution(-3, 3)})  # as by SIGKILL
    assert slalom.tune(made, SPACE, trials=26, confirm=20, quiet=True)["trials"] == found["trials"] + 1
    assert optuna.load_study(study_name="slalom", storage=f"sqlite:///{tmp_path}/t/optuna.db").trials[-1].params["x"] == killed.params["x"]
    with pytest.raises(ValueError, match="tune.json: the folder has runs of other settings"):
        slalom.tune(study.Function(tmp_path / "t", function=bowl, seeds=31), SPACE)


def test_a_problem_is_tuned_in_closed_loop(tmp_path):
    found = slalom.tune(slalom.Pendulum(), {"temperature": (0.01, 10.0), "guides": (0, 2)}, trials=2, out=tmp_path, start=[0.3, 0], steps=5,
                        horizon=5, samples=16, input_min=-5, input_max=5, quiet=True)
    assert found["trials"] == 2 and found["before"] > 0 and "Score, the less" in found["file"].read_text()


def test_the_car_and_the_navigator_are_tuned_from_the_shell(tmp_path):
    pytest.importorskip("slalom._driving")
    try:
        program = study.path_of("slalom")
    except FileNotFoundError as error:
        pytest.skip(str(error))

    def said(*words, status=0):
        ended = subprocess.run([program, *words], capture_output=True, text=True, cwd=tmp_path, check=False,
                               env={**study.os.environ, "SLALOM_PYTHON": sys.executable})
        assert ended.returncode == status, ended.stderr
        return ended.stdout + ended.stderr

    car = ["tune", "car", "--course=wren", "--config=default_kinematic", "--methods=mppi", "--seeds=2", "--trials=1", "--out=car"]
    assert "trial 1: " in said(*car, "--vary=mppi.samples=16..64", "--set=mppi.temperature=2")
    assert "base: default_kinematic\nmppi:\n  temperature: 2" in (tmp_path / "car/best.yaml").read_text()
    said("eval", "--course=wren", "--config=car/best.yaml", "--methods=mppi", "--laps=1", "--out=again")
    assert json.loads((tmp_path / "again/settings.json").read_text())["options"]["mppi"]["temperature"] == 2
    robot = ["tune", "navigator", "--scenario=straight", "--seeds=1", "--trials=1", "--out=robot", "--set=samples=64"]
    assert "samples: 64" in said(*robot, "--vary=noise_exponent=1.0..3.0")
    assert "must be key=LOW..HIGH" in said(*robot, "--vary=noise_exponent", status=2)
    assert "must be car, navigator or suite" in said("tune", "cat", "--vary=a=1..2", "--out=cat", status=2)


@pytest.mark.parametrize("name, call", [("optuna", lambda: slalom.tune), ("distributed", lambda: study.connect("tcp://nowhere")),
                                        ("matplotlib", lambda: study.needed("matplotlib.none"))])
def test_a_missing_package_is_named(name, call, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "slalom.tuner", raising=False)
    with pytest.raises(ImportError, match=f"install python3-{name} "):
        call()
