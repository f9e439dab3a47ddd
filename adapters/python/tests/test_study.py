"""Studies are those of `slalom eval`, and survive every fault."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from slalom import study

sys.path.insert(0, str(Path(__file__).parent))
import study_faults as faults  # noqa: E402

pytest.importorskip("slalom._driving")
CALLS = Path("unset")


def noted(seed, x=0.0, kind="a"):
    """A score; each call is noted in a file."""
    with CALLS.open("a") as file:
        file.write(f"{seed}\n")
    return seed + x / 3 + (0.5 if kind == "a" else 0)


@pytest.fixture
def calls(tmp_path, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "CALLS", tmp_path / "calls")
    return tmp_path / "calls"


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """An evaluation that `slalom eval` drove alone, and the study that is the same."""
    folder = tmp_path_factory.mktemp("alone")
    try:
        subprocess.run([study.path_of("slalom"), "eval", *faults.WORLD, "--laps=3", f"--out={folder}"], check=True, capture_output=True)
    except FileNotFoundError as error:
        pytest.skip(str(error))
    options = dict(word.removeprefix("--").split("=", 1) for word in faults.WORLD if not word.startswith("--set"))
    sets = [word.removeprefix("--set=") for word in faults.WORLD if word.startswith("--set")]
    return folder, lambda out: study.Laps(out, **options, set=sets, laps=3)


def test_laps_are_those_of_slalom_eval_and_a_torn_journal_is_continued(alone, tmp_path):
    (folder, laps), rows = alone, list(study.run(alone[1](tmp_path / "a"), quiet=True))
    assert faults.repeatable(tmp_path / "a") == faults.repeatable(folder)
    assert len(rows) == 6 and rows[0]["method"] == "mppi" and rows[-1]["lap"] == 2
    header, *lines = (tmp_path / "a" / study.TABLE).rename(tmp_path / "whole").read_text().splitlines()
    (tmp_path / "a" / study.JOURNAL).write_text("\n".join([header, lines[4], lines[1], lines[2][:90]]))
    list(study.run(laps(tmp_path / "a"), quiet=True))
    kept = (tmp_path / "a" / study.TABLE).read_text().splitlines()
    assert [kept[1:][k] == lines[k] for k in range(6)] == [False, True, False, False, True, False], "clock times of laps that were kept"
    assert faults.repeatable(tmp_path / "a") == faults.repeatable(folder)
    with pytest.raises(RuntimeError, match="seed0: 0 stored, 1 requested"):
        study.run(study.Laps(tmp_path / "a", **{**laps("").options, "seed": 1}))


def test_a_function_of_a_seed_is_never_called_twice(calls, tmp_path):
    made = study.Function(tmp_path / "f", function=noted, seeds=20, seed=5, set=["x=2", "kind=b"])
    rows = list(study.run(made, jobs=2, quiet=True))
    assert sorted(map(int, calls.read_text().split())) == list(range(5, 25))
    assert rows[3]["score"] == noted(8, 2, "b") and rows[3]["set"] == "x=2 kind=b"
    assert list(study.run(made, quiet=True)) == rows and len(calls.read_text().split()) == 21
    with pytest.raises(ValueError, match="other settings"):
        study.run(study.Function(tmp_path / "f", function=noted, seeds=21), quiet=True)


def test_a_full_disk_loses_nothing(calls, tmp_path):
    made = study.Function(tmp_path / "f", function=noted, seeds=40)
    script = (f"import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
              f"import test_study as t; t.CALLS = t.Path({str(calls)!r}); resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))\n"
              f"t.study.run(t.study.Function({str(tmp_path / 'f')!r}, function=t.noted, seeds=40), jobs=1, quiet=True)\n")
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert ended.returncode == 1 and "laps.journal.csv" in ended.stderr, ended.stderr
    kept = (tmp_path / "f" / study.JOURNAL).read_bytes().count(b"\n") - 1
    assert kept > 5
    calls.unlink()
    assert len(list(study.run(made, quiet=True))) == 40 and len(calls.read_text().split()) == 40 - kept


def test_worker_scheduler_and_study_are_killed(alone, tmp_path):
    pytest.importorskip("distributed")
    faults.check(tmp_path, 12, 1)


def test_a_worker_of_another_build_is_refused(alone, tmp_path):
    distributed = pytest.importorskip("distributed")
    other = tmp_path / "bin"
    other.mkdir()
    build = bytes.fromhex(study.build_of(study.path_of("slalom")))
    (other / "slalom").write_bytes(Path(study.path_of("slalom")).read_bytes().replace(build, b"\0" * 6))
    (other / "slalom").chmod(0o755)
    folder, laps = alone
    with faults.Cluster(workers=0) as cluster, distributed.Client(cluster.address, timeout=120, set_as_default=False) as client:
        cluster.start_worker(SLALOM_PROGRAM=str(other / "slalom"))
        with pytest.raises(study.OtherBuild, match="is build 000000000000, the study has " + build.hex()):
            study.run(laps(tmp_path / "refused"), client, quiet=True)
        faults.end(cluster.workers.pop())
        cluster.start_worker()
        list(study.run(laps(tmp_path / "refused"), client, quiet=True))
    assert faults.repeatable(tmp_path / "refused") == faults.repeatable(folder)


def test_rooms_are_driven_as_by_slalom_navigate(alone, tmp_path):
    words = ["--scenario=straight", "--methods=mppi", "--set=samples=64"]
    rows = list(study.run(study.Rooms(tmp_path / "r", scenario="straight,heading", methods="mppi", set=["samples=64"], seeds=2, seed=3), quiet=True))
    said = subprocess.run([study.path_of("slalom"), "navigate", *words, "--seeds=2", "--seed=3", "--json=-"], capture_output=True, check=False).stdout
    for row, drive in zip(rows, json.loads(said)["results"][0]["by_seed"]):
        assert row["scenario"] == "straight" and all(row[name] == each for name, each in drive.items() if not name.startswith("update"))
    assert [row["scenario"] for row in rows] == ["straight"] * 2 + ["heading"] * 2
    for options, text in ({"scenario": "rooms"}, "must name rooms"), ({"scenario": "bay", "methods": "mppi,icem"}, "must be one method"):
        with pytest.raises(ValueError, match=text):
            study.run(study.Rooms(tmp_path / text, seeds=1, **{"set": ["samples=4"], **options}), quiet=True)
