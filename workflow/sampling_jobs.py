"""The jobs of a study's samplings, and of the campaign that it belongs to."""

import importlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from workflow.jobs import Job, parquet_beside
from workflow.needs import sampling_needs
from workflow.schema import Study

JOINTS = 64  # of a sampling in a batch
TABLE = "tables/samplings.csv"


@dataclass(frozen=True)
class Batch:
    """Some joints of a sampling.

    ``arguments``: for `workflow.steps.joints.joints_of`, with the directions that are asked for and
    what the static model and limit analysis need.
    """

    sampling: str
    number: int
    arguments: dict[str, Any]

    def job(
        self, kind: str, step: str, message: str, modules: tuple[str, ...] = (), **more: Any
    ) -> Job:
        """A job whose only output, in the folder ``kind``, is named after the batch."""
        name = f"{kind}/{self.sampling}-{self.number:04}"
        start, stop = self.arguments["start"], self.arguments["stop"]
        return Job(
            name=name,
            step=step,
            message=f"{message} {start + 1} to {stop} of {self.sampling}",
            inputs=(),
            outputs=(f"{name}.parquet",),
            arguments={**self.arguments, **more},
            modules=modules,
            needs=sampling_needs(stop - start),
        )


def batches(study: Study) -> Iterator[Batch]:
    """The joints of the study's samplings, in batches."""
    for name, section in study.samplings.items():
        for number, start in enumerate(range(0, section.joints, JOINTS)):
            yield Batch(
                name,
                number,
                {
                    "name": name,
                    "sampling": asdict(section.sampling()),
                    "base": asdict(study.base_joint),
                    "start": start,
                    "stop": min(start + JOINTS, section.joints),
                    "eccentricities": section.eccentricities or study.eccentricities,
                },
            )


def sampling_jobs(study: Study) -> dict[str, Job]:
    """The jobs that solve the study's samplings, then those of its campaign, by name."""
    jobs = [*_solving(study)]
    if study.campaign is not None:
        jobs += importlib.import_module(f"studies.{study.campaign}.jobs").jobs(study)
    return {job.name: job for job in jobs}


def _solving(study: Study) -> Iterator[Job]:
    """A job for each batch, and the one that puts them together in a table."""
    solved = [
        batch.job(
            "sampling",
            "workflow.steps.sampling",
            "Solve joints",
            ("workflow.solvers.static", "workflow.solvers.limit"),
            cells=study.samplings[batch.sampling].cells,
            limited=study.samplings[batch.sampling].limited,
        )
        for batch in batches(study)
    ]
    if solved:
        yield from solved
        yield table_job(
            "samplings",
            "analysis.samplings",
            "Put the samplings' batches together",
            tuple(job.outputs[0] for job in solved),
            (TABLE,),
        )


def table_job(
    name: str,
    step: str,
    message: str,
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    **arguments: Any,
) -> Job:
    """A job that writes tables or figures."""
    others = parquet_beside(outputs)
    return Job(name, step, message, inputs, outputs, arguments, others=others)
