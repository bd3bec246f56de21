"""The jobs of a study's designs: batches of joints, what the law says of them, and their tables."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from analysis.figures.catalogue import drawn_files
from workflow.jobs import Job, parquet_beside
from workflow.needs import design_needs
from workflow.schema import Study

JOINTS = 64  # of a design in a batch
LAW_FIGURES = ("law", "law_margins", "law_rules", "law_nomogram")


def design_jobs(study: Study) -> dict[str, Job]:
    """The jobs that solve the study's designs, batch by batch, and ask the law of them."""
    jobs = []
    for name, section in study.designs.items():
        told = {"design": asdict(section.design()), "base": asdict(study.base_joint)}
        directions = {"eccentricities": section.eccentricities or study.eccentricities}
        meshes = {"cells": section.cells, "limited": section.limited}
        for number, start in enumerate(range(0, section.joints, JOINTS)):
            part = {**told, "start": start, "stop": min(start + JOINTS, section.joints)}
            place = f"{name}-{number:04}"
            jobs += [
                _batch_job(
                    f"designs/{place}",
                    "workflow.steps.design",
                    f"Solve joints {start + 1} to {part['stop']} of the design {name}",
                    {**part, "asked": {**directions, **meshes}},
                    modules=("workflow.solvers.static", "workflow.solvers.limit"),
                ),
                _batch_job(
                    f"law/{place}",
                    "workflow.steps.law",
                    f"Ask the law of joints {start + 1} to {part['stop']} of {name}",
                    {**part, "asked": directions},
                ),
            ]
    return {job.name: job for job in jobs}


def _batch_job(
    name: str, step: str, message: str, arguments: dict[str, Any], modules: tuple[str, ...] = ()
) -> Job:
    """A job of a batch, whose only output is named after it."""
    output = f"{name}.parquet"
    needs = design_needs(arguments["stop"] - arguments["start"])
    return Job(name, step, message, (), (output,), arguments, modules=modules, needs=needs)


def design_tables(study: Study, found: Mapping[str, Job]) -> dict[str, Job]:
    """The jobs from the batches of designs, which the jobs ``found`` make, to their tables."""
    if not study.designs:
        return {}
    solved = [job for name, job in found.items() if name.startswith("designs/")]
    told = [job for name, job in found.items() if name.startswith("law/")]
    names = [job.name.partition("/")[2].rpartition("-")[0] for job in solved]
    points, base = "tables/points.csv", asdict(study.base_joint)
    design = asdict(next(iter(study.designs.values())).design())

    def job(name: str, message: str, outputs: tuple[str, ...], **arguments: Any) -> Job:
        """A job that makes something of all points, or of joints like the study's ones."""
        inputs = () if "base" in arguments else (points,)
        return Job(name, f"analysis.designs.{name}", message, inputs, outputs, arguments)

    together = Job(
        name="points",
        step="analysis.designs.points",
        message="Put the designs' batches together",
        inputs=tuple(job.outputs[0] for job in (*solved, *told)),
        outputs=(points,),
        arguments={"designs": names},
    )
    drawn = Job(
        name="law_figures",
        step="analysis.figures.law",
        message="Draw the law",
        inputs=(points,),
        outputs=tuple(drawn_files(LAW_FIGURES)),
        arguments={},
    )
    jobs = (
        together,
        job(
            "errors",
            "Hold law and rules against the static model",
            ("tables/law.csv", "tables/rules.csv"),
        ),
        job("interaction", "Hold curves between both ends against it", ("tables/interaction.csv",)),
        job("bonds", "Tell what bonds that fade add", ("tables/bonds.csv",)),
        job("freedoms", "Fit contact points to the designs' peaks", ("tables/freedoms.csv",)),
        job(
            "sensitivity",
            "Tell which parameter the first failure hangs on",
            ("tables/sensitivity.csv",),
            design=design,
            base=base,
        ),
        job(
            "characteristic",
            "Tell what scatter of the locks' strength costs",
            ("tables/characteristic.csv",),
            base=base,
        ),
        job(
            "assumed_sizes",
            "Tell what hangs on sizes that are assumed",
            ("tables/assumed_sizes.csv",),
            base=base,
        ),
        drawn,
    )
    return {job.name: replace(job, others=parquet_beside(job.outputs)) for job in jobs}
