"""``surmount teachers``: which teacher helps on which kind of task, by a written plan."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from surmount.cli.main import INTERRUPTED
from surmount.cli.part_progress import PartProgress
from surmount.cli.workers import WorkerOptions, Workers

RECORD = "comparison.json"


def teachers(
    plan: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="PLAN.toml")],
    *,
    out: Annotated[Path, tyro.conf.arg(metavar="DIR")],
    headroom: bool = False,
    tasks: Annotated[tuple[str, ...], tyro.conf.arg(metavar="NAME")] = (),
    measured: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None,
    workers: WorkerOptions = Workers(),  # noqa: B008 - frozen
) -> int:
    """Run a comparison of teachers, network by network, and say what can be said so far.

    Writes comparison.json with every network's success, and the page. Calling it again goes on
    where it stopped; more networks or teachers may be added to the plan meanwhile.

    Args:
        plan: TOML file with tasks, teachers, budgets and numbers of networks.
        out: Folder for networks, trials and the page.
        headroom: Run only uniform tasks and the oracle, on the pilot's networks.
        tasks: Names of the tasks to run; all of the plan if left out.
        measured: comparison.json of networks measured before, perhaps on another machine; those of
            the same settings are taken over and not run again.
        workers: Where stages run.
    """
    with PartProgress() as telling:
        telling(f"reading {plan}")
        # After the first line: what learns takes seconds to import.
        from surmount.core.errors import ConfigError
        from surmount.core.records import write_record
        from surmount.studies.teachers.graph import comparison_stages
        from surmount.studies.teachers.judging import judge
        from surmount.studies.teachers.outcomes import NOTHING, read_earlier
        from surmount.studies.teachers.outcomes import measured as measured_in
        from surmount.studies.teachers.page import write_page
        from surmount.studies.teachers.plan import read_plan
        from surmount.studies.teachers.reading import answer
        from surmount.workflow.console import SafeConsole
        from surmount.workflow.progress import run_graph
        from surmount.workflow.provenance import provenance
        from surmount.workflow.store import output_errors, sole_user

    workers.checked()
    plans = read_plan(plan)
    unknown = [name for name in tasks if name not in {one.label for one in plans}]
    if unknown:
        raise ConfigError(
            f"The plan has no task `{unknown[0]}`.",
            remedy=f"Choose among {', '.join(one.label for one in plans)}.",
        )
    chosen = [one for one in plans if not tasks or one.label in tasks]
    earlier, others = (
        ({one.label: NOTHING for one in plans}, [])
        if measured is None
        else read_earlier(measured, plans)
    )
    console = SafeConsole()
    for sentence in others:
        console.print(sentence)
    graph = comparison_stages(
        chosen,
        headroom_only=headroom,
        known=lambda plan, teacher, network: earlier[plan.label].has(teacher, network),
    )
    with sole_user(out):
        outcome = run_graph(
            out, graph, workers.make, console, store=workers.store, retries=workers.retries
        )
        record = judge(
            plans,
            {
                one.label: measured_in(one, outcome.artefacts).with_earlier(earlier[one.label])
                for one in plans
            },
        )
        with output_errors(out):
            write_record(out / RECORD, {**record, **provenance()})
            page = write_page(record, out)
    for sentence in answer(record["tasks"]):
        console.print(sentence)
    console.print(str(page))
    if outcome.interrupted:
        console.print("Stopped. Go on with the same command.")
        return INTERRUPTED
    return 0
