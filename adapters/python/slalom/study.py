"""Studies: many runs, each a function of its seed, on this machine or a Dask cluster, kept in the folder of `slalom eval`:
docs/studies.md. The call of a study that was stopped continues it. No run that is in the folder is driven again."""

import collections
import concurrent.futures
import contextlib
import csv
import ctypes
import fcntl
import importlib
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from . import _slalom

JOURNAL, TABLE = "laps.journal.csv", "laps.csv"


class OtherBuild(RuntimeError):
    """This machine has another build of the program than the study."""


class RunError(RuntimeError):
    """A program ended with an error."""


def path_of(program: str) -> str:
    """The path of a program: beside $SLALOM_PROGRAM or this package, or of the PATH."""
    folders = [Path(os.environ.get("SLALOM_PROGRAM", "/nowhere")).parent, *(each / "bin" for each in Path(__file__).parents)]
    if not (found := next((str(each / program) for each in folders if (each / program).is_file()), None) or shutil.which(program)):
        raise FileNotFoundError(f"the program {program} is missing: build it with CMake, or set SLALOM_PROGRAM to slalom's path")
    return found


def build_of(file: str) -> str:
    """The GNU build id of a program or module, as settings.json has it; "unknown" without one."""
    found = re.search(rb"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0(.{6})", Path(file).read_bytes(), re.DOTALL)
    return found[1].hex() if found else "unknown"


def outputs_of(build: str, commands: list[list[str]], text: str = "") -> list[str]:
    """The output of commands of a program. Raises OtherBuild if it is not this build."""
    path, outputs = path_of(commands[0][0]), []
    if build != build_of(path):
        raise OtherBuild(f"{path} of {socket.gethostname()} is build {build_of(path)}, the study has {build}")
    for _, *words in commands:
        ended = subprocess.run([path, *words], input=text, capture_output=True, text=True, check=False)
        if ended.returncode > (1 if ended.stdout else 0) or ended.returncode < 0:  # 1 is a collision of `slalom navigate`
            raise RunError(ended.stderr.strip() or f"{path} ended with status {ended.returncode}")
        outputs.append(ended.stdout)
    return outputs


def value_of(text: str) -> Any:
    """The number or bool that a text is, or the text."""
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return {"true": True, "false": False}.get(text.lower(), text)


def needed(module: str, package: str = "") -> Any:
    """A module of another package. Raises ImportError that names the package."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        name = module.partition(".")[0]
        raise ImportError(f"{error}: install python3-{name} (Debian), or {package or name} of the index") from None


def keep(file: Path, settings: str) -> None:
    """Writes the settings of a folder. Raises ValueError if it has others."""
    if file.exists() and file.read_text() != settings:
        raise ValueError(f"{file}: the folder has runs of other settings or of another build; choose another folder")
    file.write_text(settings)


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Holds the lock of a folder. Raises RuntimeError if another process has it."""
    with (folder / "lock").open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RuntimeError(f"{folder}: is in use by another process: wait until it has ended") from None
        try:
            yield
        finally:
            fcntl.flock(lock, fcntl.LOCK_UN)  # the processes of the pool have the file, too


class Study:
    """Runs that the folder `out` keeps, of `methods`, a method, with the options `set`, a list of "key=value": run k of each
    place, of those that the option `where` names with commas between, has the seed `seed` + k. Others go to its program."""

    program, count, where = "slalom", "seeds", "scenario"
    scored, stride = "the score of a run", 1  # for a tuner: what it makes small, and the difference of the seeds of two runs

    def __init__(self, out: Any, **options: Any):
        self.out, self.options = Path(out), dict[str, Any]({"methods": "svg_mppi", "set": [], "seed": 0, self.count: 32}, **options)
        self.method, self.sets, self.seed = self.options["methods"], self.options["set"], int(self.options["seed"])
        self.build, self.counted = build_of(path_of(self.program)), int(self.options[self.count])
        places = str(self.options.get(self.where, "")).split(",")
        self.experiments = [tuple[str, ...]([self.method, each, " ".join(self.sets).replace(",", ";")]) for each in places]
        self.runs = [(experiment, run_) for experiment in range(len(places)) for run_ in range(self.counted)]

    def score(self, row: dict[str, Any]) -> float:
        """The figure that a tuner makes small."""
        return float(row["score"])

    def words(self, *without: str) -> list[str]:
        """The options as words of a command."""
        given = {name: value for name, value in self.options.items() if name not in ("set", *without)}
        return [word for name, value in given.items() for word in ("--" + name.replace("_", "-"), str(value)) if word != "True"]

    def command(self, experiment: int, run_: int) -> list[str]:
        """The command that a run of an experiment is."""
        if "," in self.method:
            raise ValueError(f"methods: '{self.method}' must be one method")
        return [self.program, *self.words("seed", "seeds", self.where), "--seeds", "1", f"--{self.where}", self.experiments[experiment][1]]

    def figures(self, output: Any) -> dict[str, Any]:
        """Those in the output of a run."""
        return output if isinstance(output, dict) else {"score": output}

    def work(self, runs: list[tuple[int, int]]) -> tuple[Any, ...]:
        """A function and its arguments, for a worker."""
        return outputs_of, self.build, [self.command(*each) for each in runs]

    def settings(self) -> str:
        """The text of settings.json."""
        settings = {"kind": type(self).__name__, "build": self.build, **self.options}
        return json.dumps(settings, indent=2, default=lambda each: getattr(each, "__name__", type(each).__name__)) + "\n"

    def prepare(self) -> None:
        """Makes the folder. Raises ValueError if it has other runs."""
        self.out.mkdir(parents=True, exist_ok=True)
        keep(self.out / "settings.json", self.settings())

    def lines(self, runs: list[tuple[int, int]], outputs: list[Any]) -> list[str]:
        """The header of the table and the lines of these runs."""
        rows = [self.figures(output) for output in outputs]
        cells = ([*self.experiments[experiment], run_, *row.values()] for (experiment, run_), row in zip(runs, rows))
        return [",".join(map(str, each)) for each in (["method,scenario,set,lap", *rows[0]], *cells)]

    def place(self, line: str) -> tuple[int, int]:
        """Experiment and run of a line."""
        *experiment, run_ = line.split(",", 4)[:4]
        return self.experiments.index(tuple(experiment)), int(run_)

    def finish(self, quiet: bool) -> None:
        """Writes the table from the journal, which is whole."""
        if (self.out / JOURNAL).exists():
            header, *lines = (self.out / JOURNAL).read_text().splitlines()
            (self.out / JOURNAL).write_text("\n".join([header, *sorted(lines, key=self.place), ""]))
            (self.out / JOURNAL).replace(self.out / TABLE)

    def rows(self) -> Iterator[dict[str, Any]]:
        """The rows of the table, by column."""
        with (self.out / TABLE).open(newline="") as file:
            yield from ({name: value_of(cell) for name, cell in row.items()} for row in csv.DictReader(file))


class Laps(Study):
    """Laps of cars: an evaluation of `slalom eval` with these options, `_` for `-`; `laps` is their number."""

    count, scored = "laps", "the time of a lap in s, 10 more for each collision, and 60 where it does not finish"

    def __init__(self, out: Any, **options: Any):
        super().__init__(out, **options)
        self.stride = int(self.options.get("obstacles", 5)) + 5
        self.line = ["eval", "--resume", "--out", str(out), *self.words(), *(f"--set={each}" for each in self.sets)]

    def prepare(self) -> None:
        outputs_of(self.build, [["slalom", *self.line, "--prepare"]])
        self.text = (self.out / "settings.json").read_text()
        found = json.loads(self.text)["experiments"]
        self.experiments = [(each["method"], each["scenario"], each["set"]) for each in found]
        self.runs = [(experiment, lap) for experiment, each in enumerate(found) for lap in range(each["laps"])]

    def work(self, runs: list[tuple[int, int]]) -> tuple[Any, ...]:
        words = ["slalom", "eval", "--part", " ".join(f"{experiment}:{lap}" for experiment, lap in runs)]
        return outputs_of, self.build, [words], self.text

    def lines(self, runs: list[tuple[int, int]], outputs: list[Any]) -> list[str]:
        return ["", *outputs[0].splitlines()]  # the program has written the header

    def score(self, row: dict[str, Any]) -> float:
        return float(row["time"] + 10 * row["collisions"] + 60 * (not row["finished"]))

    def finish(self, quiet: bool) -> None:
        [said] = outputs_of(self.build, [["slalom", *self.line, "--resume"]])
        print("" if quiet else said, end="")


class Rooms(Study):
    """Drives of `slalom navigate` through the rooms of `scenario`, each with `seeds` seeds."""

    scored = "the time of a drive in s, and 60 more where it fails"

    def score(self, row: dict[str, Any]) -> float:
        return float(row["time_s"] + 60 * (not row["success"]))

    def command(self, experiment: int, run_: int) -> list[str]:
        words = ["--json", "-", "--seed", str(self.seed + run_), *(f"--set={each}" for each in self.sets)]
        return ["slalom", "navigate", *super().command(experiment, run_)[1:], *words]

    def figures(self, output: Any) -> dict[str, Any]:
        if len(every := json.loads(output)["results"]) > 1:  # `rooms`, `manoeuvres`
            raise ValueError(f"scenario: '{self.options['scenario']}' must name rooms, with commas between; `slalom navigate --help` lists them")
        return {name: int(each) if isinstance(each, bool) else each for name, each in every[0]["by_seed"][0].items()}


class Suite(Study):
    """Runs of `slalom_problem_suite`, of a build tree, on `tasks` with so many `rollouts` in a solve, 64 if not given."""

    program, where, scored = "slalom_problem_suite", "tasks", "1 for a run that fails"

    def command(self, experiment: int, run_: int) -> list[str]:
        words = ["--first-seed", str(self.seed + run_), "--methods", ":".join([self.method, *self.sets])]
        return [*super().command(experiment, run_), *words, *([] if "rollouts" in self.options else ["--rollouts", "64"])]

    def figures(self, output: Any) -> dict[str, Any]:
        row = next(csv.DictReader(output.splitlines()))
        return {"score": 1 - int(row["solved"]), "cost": row["median_cost"]}


def _calls(function: Callable[..., Any], seeds: list[int], values: dict[str, Any]) -> list[Any]:
    return [function(seed, **values) for seed in seeds]


class Function(Study):
    """Calls of a module's `function(seed, **values)`, the values those of `set`: a number, the score, or a dict of figures."""

    program = _slalom.__file__

    def work(self, runs: list[tuple[int, int]]) -> tuple[Any, ...]:
        values = {key: value_of(text) for key, text in (each.split("=", 1) for each in self.sets)}
        return _calls, self.options["function"], [self.seed + run_ for _, run_ in runs], values


def _timed(call: Callable[..., Any], *arguments: Any) -> tuple[Any, float]:
    """On a worker: what the call returns, and the seconds that it takes."""
    begin = time.monotonic()
    return call(*arguments), time.monotonic() - begin


def _end_with_parent() -> None:
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _drive(study: Study, client: Any, jobs: int, seconds: float, quiet: bool) -> None:
    journal, spent, threads, begin = study.out / JOURNAL, 0.0, jobs or os.cpu_count() or 1, time.monotonic()
    pending: dict[concurrent.futures.Future[Any], list[tuple[int, int]]] = {}
    journal.touch()
    os.truncate(journal, journal.read_bytes().rfind(b"\n") + 1)
    done = {study.place(line) for line in journal.read_text().splitlines()[1:]}
    todo = collections.deque(each for each in study.runs if each not in done)
    left = whole = len(todo)
    own = concurrent.futures.ProcessPoolExecutor(threads, initializer=_end_with_parent)
    pool = client.get_executor(pure=False) if client else own
    with journal.open("ab", buffering=0) as file, contextlib.ExitStack() as at_end:
        at_end.callback(own.shutdown, wait=False, cancel_futures=True)
        at_end.callback(lambda: [each.cancel() for each in pending])
        while left:
            if client and client.status == "closed":
                raise ConnectionError("the scheduler was lost; the runs so far are kept, and the same call continues")
            with contextlib.suppress(OSError):  # no scheduler at present
                threads = sum(client.nthreads().values()) if client else threads
            while todo and len(pending) < 2 * threads + 2:  # short tasks at first, and at the end
                size = min(int(seconds * (whole - left) / spent) if spent else 1, left // (2 * threads + 2), len(todo))
                part = [todo.popleft() for _ in range(max(size, 1))]
                pending[pool.submit(_timed, *study.work(part))] = part
            for future in concurrent.futures.wait(pending, 1, concurrent.futures.FIRST_COMPLETED).done:
                part = pending.pop(future)
                try:
                    outputs, elapsed = future.result()
                except concurrent.futures.CancelledError:  # the scheduler was lost
                    todo.extendleft(reversed(part))
                    continue
                header, *lines = study.lines(part, outputs)
                if len(lines) != len(part):
                    raise RuntimeError(f"a worker returned {len(lines)} of {len(part)} runs")
                text = "".join(f"{line}\n" for line in ([header] if header and not file.tell() else []) + lines).encode()
                if file.write(text) < len(text):
                    raise OSError(f"{journal}: cannot be written: the disk is full")
                left, spent = left - len(part), spent + elapsed
                if not quiet and sys.stderr.isatty():
                    bar, rest = "#" * (30 - 30 * left // whole), (time.monotonic() - begin) / (whole - left) * left
                    print(f"\r[{bar:30}] {left} of {whole} left, {rest:.0f} s ", end="" if left else "\n", file=sys.stderr)


def run(study: Study, client: Any = None, *, jobs: int = 0, seconds: float = 5, quiet: bool = False) -> Iterator[dict[str, Any]]:
    """Drives the runs that the folder lacks, in `jobs` processes of this machine (0: one a core) or on the workers of a
    `dask.distributed.Client`, in tasks of about so many seconds; returns the rows of all. Raises what a run raised, ValueError
    for a folder of another study, OtherBuild without a worker of this build, and OSError where the folder cannot be written."""
    study.prepare()
    with locked(study.out):
        if not (study.out / TABLE).exists():
            _drive(study, client, jobs, seconds, quiet)
    study.finish(quiet)
    return study.rows()


def words_of_process() -> list[str]:
    """The words of this process; "--option=value" are two."""
    return [part for word in sys.argv[1:] for part in (word.split("=", 1) if word.startswith("--") else [word])]


def end_with(module: str) -> None:
    """Calls `main` of a module of this package, with the exit status and the errors of the program."""
    try:
        importlib.import_module(module, __package__).main()
    except KeyboardInterrupt:
        print("\nslalom: interrupted; the runs so far are kept", file=sys.stderr)
        os._exit(130)
    except Exception as error:
        sys.exit(f"slalom: {error}")


def connect(address: str) -> Any:
    """A Dask client of a scheduler, which waits ten minutes for one that was lost."""
    Client = needed("distributed").Client
    Client(address, timeout=60, set_as_default=False).close()
    return Client(address, timeout=600, set_as_default=False)


def main() -> None:
    """Does `slalom eval --cluster`, whose words are those of this process."""
    words = words_of_process()
    laps, address = Laps(words[words.index("--out") + 1]), words.index("--cluster")
    laps.line = ["eval", *words[:address], *words[address + 2:]]
    run(laps, connect(words[address + 1]))
