"""Tuning by Optuna: options that make the runs of studies better, compared run by run on the same seeds: docs/studies.md."""

import functools
import hashlib
import sys
import threading
import time
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _slalom, study as studies
from .closed_loop import run

optuna = studies.needed("optuna")
studies.needed("sklearn", "scikit-learn")  # Optuna's importances
COMPLETE, PRUNED, RUNNING, FAIL = (getattr(optuna.trial.TrialState, name) for name in ("COMPLETE", "PRUNED", "RUNNING", "FAIL"))


def is_worse(differences: npt.ArrayLike, level: float = 0.05) -> bool:
    """Whether paired differences of scores are above zero, by a test that flips their signs at random."""
    values = np.asarray(differences, float)
    flipped = np.random.default_rng(0).choice([-1.0, 1.0], (4000, values.size)) @ values
    return bool(np.mean(flipped >= values.sum() - 1e-9) < level)


def interval(differences: npt.ArrayLike) -> list[float]:
    """The 95 % interval of the mean, by bootstrap."""
    values = np.asarray(differences, float)
    means = np.random.default_rng(0).choice(values, (10000, values.size)).mean(axis=1)
    return [float(x) for x in np.quantile(means, [0.025, 0.975])]


class Paired(optuna.pruners.BasePruner):  # type: ignore[name-defined,misc]
    """Prunes a trial that is worse than the best one on the runs that it has driven."""

    def prune(self, study: Any, trial: Any) -> bool:
        scores, best = (np.asarray(each.user_attrs["scores"]) for each in (trial, study.best_trial))
        return is_worse(scores - best[:scores.size])


def distribution(values: Any) -> Any:
    """Optuna's distribution of an option: (low, high), by the logarithm if high is ten times low or more, or a list of values."""
    if isinstance(values, tuple):
        kind = "IntDistribution" if all(type(x) is int for x in values) else "FloatDistribution"
        return getattr(optuna.distributions, kind)(*values, log=0 < 10 * values[0] <= values[1])
    return optuna.distributions.CategoricalDistribution(values) if isinstance(values, list) else values


def sets_of(values: Mapping[str, Any]) -> list[str]:
    """Values as words of a command."""
    return [f"{name}={value:.4g}" if isinstance(value, float) else f"{name}={str(value).lower() if isinstance(value, bool) else value}"
            for name, value in values.items()]


def closed_loop(seed: int, *, problem: Any, start: Any, steps: int, options: dict[str, Any], **values: Any) -> float:
    """The cost of a closed loop with `svg_mppi`."""
    every: dict[str, Any] = {**options, **values, "seed": seed}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # symptoms: some values are poor
        return float(run(problem, _slalom.SvgMppi(problem, **every), start, steps=steps).costs.sum())


class Tuner:
    """Trials of options, each of which drives the runs of `given` with them. The folder of the first keeps all."""

    def __init__(self, given: list[studies.Study], space: Mapping[str, Any], sampler: Any, pruner: Any, **running: Any):
        self.given, self.running, self.lock, self.out = given, running, threading.Lock(), given[0].out
        self.space, count = {name: distribution(values) for name, values in space.items()}, given[0].counted
        cuts = [0, *(2 ** k for k in range(3, 30) if 2 ** k < count), count]  # rounds of 8, 8, 16, 32, ... runs, and a test after each
        self.rounds = [(first, last - first) for first, last in zip(cuts, cuts[1:])]
        studies.keep(self.out / "tune.json", "".join(each.settings() for each in given))
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        self.study = optuna.create_study(storage=f"sqlite:///{self.out}/optuna.db", study_name="slalom", load_if_exists=True,
                                         sampler=sampler, pruner=pruner or Paired())
        self.study.sampler = sampler or optuna.samplers.TPESampler(seed=len(self.study.trials))
        self.before: list[float] = sum((self.scores([], *each) for each in self.rounds), [])
        for trial in self.study.trials:  # those that were being driven come first; what they drove is kept
            if trial.state == RUNNING:
                self.study.tell(trial.number, state=FAIL)
                self.study.enqueue_trial(trial.params)
        if not self.study.trials:
            self.study.add_trial(optuna.trial.create_trial(value=0.0, user_attrs={"scores": self.before}))

    def scores(self, sets: list[str], first: int, count: int) -> list[float]:
        """The scores of so many runs of each study from the run `first` on."""
        key, found = hashlib.sha256(" ".join(sets).encode()).hexdigest()[:16] if sets else "before", []
        for k, each in enumerate(self.given):
            options = {**each.options, each.count: count, "seed": each.seed + each.stride * first, "set": [*each.sets, *sets]}
            part = type(each)(self.out / "runs" / key / f"{k}-{first}-{count}", **options)
            found += [each.score(row) for row in studies.run(part, quiet=True, **self.running)]
        return found

    def drive(self, trial: Any) -> None:
        """Drives a trial until it is pruned or whole. Its value is the mean difference of its scores from those before."""
        scores: list[float] = []
        for each in self.rounds:
            scores += self.scores(sets_of(trial.params), *each)
            value = float(np.mean(np.subtract(scores, self.before[:len(scores)])))
            with self.lock:
                trial.set_user_attr("scores", scores)
                trial.report(value, len(scores))
                if trial.should_prune():
                    self.study.tell(trial, state=PRUNED)
                    return
        with self.lock:
            self.study.tell(trial, value)

    def work(self, latest: float, trials: int, quiet: bool) -> None:
        """Drives trials until the time is over or there are so many."""
        while time.monotonic() < latest:
            with self.lock:
                if sum(each.state in (COMPLETE, PRUNED, RUNNING) for each in self.study.trials) > trials:  # the first is no trial
                    return
                trial = self.study.ask(self.space)
            try:
                self.drive(trial)
            except (studies.RunError, ValueError) as error:  # such as options that do not go together
                with self.lock:
                    self.study.tell(trial, state=PRUNED)  # without a value: the sampler avoids it
                if len(self.finished()) < 2:
                    raise
                print(f"trial {trial.number}: {' '.join(sets_of(trial.params))}: {error}", file=sys.stderr)
                continue
            if not quiet:
                done = self.study.trials[trial.number]
                print(f"trial {done.number}: {done.value:+.4g} after {len(done.user_attrs['scores'])} runs, best {self.study.best_value:+.4g}: "
                      f"{' '.join(sets_of(done.params))}", file=sys.stderr, flush=True)

    def finished(self) -> list[Any]:
        """The runs before any trial, and the trials that are whole or pruned."""
        return [each for each in self.study.trials if each.value is not None]

    def importances(self) -> dict[str, float]:
        """The shares of the options in the differences of all trials, pruned ones, too: Optuna's fANOVA."""
        whole, fanova = optuna.create_study(), optuna.importance.FanovaImportanceEvaluator(seed=0)
        whole.add_trials([optuna.trial.create_trial(params=each.params, distributions=each.distributions, value=each.value)
                          for each in self.finished()[1:]])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return dict(optuna.importance.get_param_importances(whole, evaluator=fanova)) if len(whole.trials) > 1 else {}

    def result(self, confirm: int) -> dict[str, Any]:
        """Drives the best options on fresh seeds beside those before, and writes them with this evidence to a configuration file."""
        best, trials, given = self.study.best_trial, self.finished()[1:], self.given[0]
        sets, shares, file = sets_of(best.params), self.importances(), self.out / "best.yaml"
        before, after = (np.array(self.scores(each, given.counted, confirm if sets else 1), float) for each in (sets[:0], sets))
        low, high = interval(after - before)
        verdict = "better" if high < 0 else "worse" if low > 0 else "no difference beyond chance" if sets else "no trial was better"
        text = (f"# By slalom tune, {time.strftime('%Y-%m-%d')}, build {given.build}: {len(trials)} trials of up to {len(self.before)} runs, "
                f"{sum(each.state == PRUNED for each in trials)} of them pruned. Shares of the options in their differences:\n# "
                f"{', '.join(f'{name} {100 * share:.0f} %' for name, share in shares.items()) or 'too few trials'}.\n"
                + "".join(f"# {type(each).__name__}: {' '.join(each.words('out', 'function'))}\n" for each in self.given)
                + f"# Score, the less the better: {given.scored}. {len(after)} runs on fresh seeds: {after.mean():.5g} in place of\n"
                f"# {before.mean():.5g}, difference {np.mean(after - before):+.4g} [{low:+.4g}, {high:+.4g}] (95 %): {verdict}.\n")
        laps, sections = isinstance(given, studies.Laps), dict[str, str]()
        for name, value in (each.split("=", 1) for each in [*given.sets, *sets]):
            section, _, key = (f"{given.method}.{name}" if laps and "." not in name else name).rpartition(".")
            sections[section] = sections.get(section, f"{section}:\n" if section else "") + f"{'  ' if section else ''}{key}: {value}\n"
        file.write_text(text + (f"base: {given.options.get('config', 'default')}\n" if laps else "") + "".join(sections.values()))
        return {"values": best.params, "before": float(before.mean()), "after": float(after.mean()), "interval": [low, high],
                "importances": shares, "trials": len(trials), "file": file}


def tune(given: Any, space: Mapping[str, Any], budget: float = 10, *, trials: int = 1 << 30, confirm: int = 0, client: Any = None,
         jobs: int = 0, sampler: Any = None, pruner: Any = None, quiet: bool = False, out: Any = "tuned", start: Any = None,
         steps: int = 100, **options: Any) -> dict[str, Any]:
    """Finds values in `space`, {option: (low, high) or [value, ...]}, with which runs score less than without them, within
    `budget` minutes and so many trials. `given` is a study or a list of them, or a problem, which `svg_mppi` with these options
    drives `steps` steps from `start`. The best values drive `confirm` runs (0: as many as a study has) on fresh seeds. All is
    kept in the folder of the study, `out` for a problem; the same call goes on there. `sampler` and `pruner` are Optuna's."""
    if not isinstance(given, (list, studies.Study)):
        call = functools.partial(closed_loop, problem=given, start=start, steps=steps, options=options)
        given = studies.Function(out, function=call, seeds=32)
    every = given if isinstance(given, list) else [given]
    every[0].out.mkdir(parents=True, exist_ok=True)
    with studies.locked(every[0].out):
        tuner = Tuner(every, space, sampler, pruner, client=client, jobs=jobs)
        workers = max(1, sum(client.nthreads().values()) // 8) if client else 1
        work = functools.partial(tuner.work, time.monotonic() + 60 * budget, trials, quiet)
        others = [threading.Thread(target=work, daemon=True) for _ in range(workers - 1)]
        for each in others:
            each.start()
        work()
        for each in others:
            each.join()
        return tuner.result(max(confirm or every[0].counted, 5))


def main() -> None:
    """Does `slalom tune`, whose words are those of this process."""
    kinds: dict[str, type[studies.Study]] = {"car": studies.Laps, "navigator": studies.Rooms, "suite": studies.Suite}
    words, kind, every = studies.words_of_process(), kinds["car"], dict[str, list[str]](set=[])
    while words:
        word = words.pop(0)
        if word.startswith("--"):
            every.setdefault(word[2:], []).append(words.pop(0))
        else:
            kind = kinds[word]
    space = {}
    for name, _, values in (each.partition("=") for each in every.pop("vary")):
        low, dots, high = values.partition("..")
        space[name] = tuple(map(studies.value_of, (low, high))) if dots else [studies.value_of(each) for each in values.split(",")]
    sets, given = every.pop("set"), dict[str, Any]({name: values[0] for name, values in every.items()})
    own: dict[str, Any] = {name: int(given.pop(name)) for name in ("trials", "confirm", "jobs") if name in given}
    budget, client = float(given.pop("minutes", 10)), studies.connect(given.pop("cluster")) if "cluster" in given else None
    given.update({kind.count: given.pop("seeds")} if "seeds" in given else {})
    places = [{"course": each} for each in given.pop("course").split(",")] if "course" in given else [{}]
    found = tune([kind(set=sets, **given, **each) for each in places], space, budget, client=client, **own)
    print(found["file"].read_text(), end="")
