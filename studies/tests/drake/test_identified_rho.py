"""rho identified during a run in Drake, on an exciting motion, against the exact model."""

from pathlib import Path

import pytest

from pushpressslide.jobs.run import Output, run_task
from pushpressslide.report.files import load_run
from pushpressslide.taskfile.load import load_task
from pushpressslide_studies.paper.identified_rho import LEAST_TIME, identified_rho
from pushpressslide_studies.paper.one_arm import IDENTIFIED_RHO


@pytest.mark.long
def test_rho_of_a_tight_turn_is_within_ten_per_cent_of_the_exact_models(
    tmp_path: Path,
) -> None:
    (variant,) = IDENTIFIED_RHO.variants
    task = load_task(variant.task, variant.settings)
    run_task(task, out=Output(tmp_path), execution=variant.execution)
    run = load_run(tmp_path)
    found = identified_rho(run.plan, run.record)
    assert found is not None
    assert found.time >= LEAST_TIME
    assert found.predicted < 0.75 * found.exact  # so that the run has to find it
    assert found.identified == pytest.approx(found.exact, rel=0.1)
    assert found.axle == pytest.approx(found.exact_axle, abs=0.01)
