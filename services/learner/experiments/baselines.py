"""Is the hierarchy better than one policy without it, on equal data, as tasks grow longer?"""

from services.learner.baselines.policy import ArmPlan, evaluator
from services.learner.baselines.scale import SCALES, TITLES, Arm
from services.learner.baselines.work import Plan, Shower, Trained, Trainer
from services.learner.experiments.bench import Bench
from services.learner.experiments.compared import findings
from services.learner.experiments.findings import Findings
from shared.evaluation.attempts import Row
from shared.evaluation.plan import ORACLE
from shared.evaluation.rows import Rows, measure
from shared.rollout.settings import RolloutSettings


def run(bench: Bench) -> Findings:
    """Demonstrate, train each arm, try each on the same scenes."""
    plan = Plan(out=bench.out, settings=SCALES[bench.scale])
    return compare(bench, plan)


def compare(bench: Bench, plan: Plan) -> Findings:
    """The same of any settings."""
    _demonstrated(bench, plan)
    trained = _trained(bench, plan)
    rows = {
        length: {arm: _tried(bench, plan, arm, length) for arm in TITLES}
        for length in plan.settings.lengths
    }
    return findings(plan.settings, trained, rows, bench.site)


def _demonstrated(bench: Bench, plan: Plan) -> None:
    jobs = range(plan.settings.data.parts)
    parts = bench.pool.work(Shower, plan, jobs)
    for _ in bench.told("demonstrations", parts, len(jobs)):
        pass


def _trained(bench: Bench, plan: Plan) -> list[Trained]:
    """All slices of all fits."""
    rounds = list(plan.slices())
    ends = [job for jobs in rounds for job in jobs if job.until == plan.settings.fit.steps]
    rows = Rows(bench.file(f"fits-{plan.note()}"), Trained, plan.note())
    found: list[Trained] = []
    tell = bench.reporter("training", sum(map(len, rounds)))
    for slices in rounds:
        for row in measure(bench.pool, Trainer, plan, slices, lambda row: row.slice, rows):
            found.append(row)
            tell()
    for last in ends:  # Only now: a row that is not kept yet needs its fit once more.
        plan.kept(last.arm, last.seed).unlink(missing_ok=True)
    return found


def _tried(bench: Bench, plan: Plan, arm: str, length: int) -> list[list[Row]]:
    """Episodes of each training seed."""
    return [
        bench.episodes(
            f"{arm}-{seed}-{length}-{plan.note()}",
            _arm_plan(bench, plan, arm, seed, length),
            evaluator,
        )
        for seed in range(plan.settings.seeds)
    ]


def _network(arm: str) -> Arm:
    """Whose network it has."""
    return "hierarchy" if arm == ORACLE else arm  # type: ignore[return-value]  # One of `TITLES`.


def _arm_plan(bench: Bench, plan: Plan, arm: str, seed: int, length: int) -> ArmPlan:
    folder = plan.arm(_network(arm), seed)
    rollout = RolloutSettings(max_steps=plan.settings.max_steps)
    if arm == "flat":  # It looks wherever it acts.
        rollout = rollout.model_copy(update={"decision_steps": rollout.execute_steps})
    return ArmPlan(
        site=bench.site,
        seeds=bench.seeds,
        tasks=tuple(bench.tasks(length)),
        skills=length,
        high_level=ORACLE if arm == ORACLE else str(folder),
        low_level=str(folder),
        rollout=rollout,
    )
