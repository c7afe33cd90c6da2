"""`hld experiment dagger`: do corrections help, how much, and is it the corrections?"""

from services.learner.experiments.bench import Bench
from services.learner.experiments.dagger.report import findings
from services.learner.experiments.dagger.run import Run, teaching_of
from services.learner.experiments.dagger.scale import SCALES, DaggerSettings
from services.learner.experiments.findings import Findings


def run(bench: Bench) -> Findings:
    """Rounds under a scripted person, and everything that they are compared with."""
    return compare(bench, SCALES[bench.scale])


def compare(bench: Bench, settings: DaggerSettings) -> Findings:
    """The same of any settings; published after each training seed but the last."""
    for seeds in range(1, settings.seeds):
        bench.publish(_found(bench, settings.model_copy(update={"seeds": seeds})))
    return _found(bench, settings)


def _found(bench: Bench, settings: DaggerSettings) -> Findings:
    tried = Run(bench, teaching_of(bench, settings)).go()
    return findings(settings, tried, bench.site)
