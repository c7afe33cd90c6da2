"""`hld experiment dagger`: do corrections help, how much, and is it the corrections?"""

from services.learner.experiments.bench import Bench
from services.learner.experiments.dagger.report import findings
from services.learner.experiments.dagger.run import Run, teaching_of
from services.learner.experiments.dagger.scale import LAB, SCALES, DaggerSettings
from services.learner.experiments.findings import Findings
from shared.errors import HldError
from shared.evaluation.plan import ORACLE


def run(bench: Bench) -> Findings:
    """Rounds under a scripted person, and everything that they are compared with."""
    return compare(bench, SCALES[bench.scale])


def compare(bench: Bench, settings: DaggerSettings) -> Findings:
    """The same of any settings; published after each training seed but the last.

    In the lab without the arm of demonstrations at the site, which are those in the lab.

    Raises:
        HldError: there is nothing to train in the oracle.
    """
    if bench.high_level == ORACLE:
        raise HldError("the oracle can't learn: --high-level names a version or a checkpoint")
    if bench.site == LAB:  # Demonstrations there are those in the lab.
        arms = tuple(name for name in settings.arms if name != "site")
        settings = settings.model_copy(update={"arms": arms})
    for seeds in range(1, settings.seeds):
        bench.publish(_found(bench, settings.model_copy(update={"seeds": seeds})))
    return _found(bench, settings)


def _found(bench: Bench, settings: DaggerSettings) -> Findings:
    tried = Run(bench, teaching_of(bench, settings)).go()
    return findings(settings, tried, bench.site)
