"""The table of capacities: every model's largest load in every direction of loading."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import pandas as pd

from analysis.published import Published, read_published
from analysis.tables import pure_shear_weights
from sidmacib.contact_points import REDUCTIONS
from sidmacib.contact_points.envelope import envelope
from sidmacib.contact_points.programme import Sidmacib, capacities
from sidmacib.errors import CapacityError
from sidmacib.joint import Direction
from sidmacib.models import LAWS, MODELS, detailed, joint_answers
from sidmacib.rule import RULES, LawCapacity
from sidmacib.rule.inverse import Demand
from sidmacib.rule.reliability import Reliability, resistances
from workflow.case import REFERENCE, case_name
from workflow.consistency import requirements
from workflow.results.tables import CAPACITY, DEMANDS, ENVELOPES, read_tables, write_tables
from workflow.schema import DemandSection, Study
from workflow.step import Arguments, Files, step


def sidmacib_rows(study: Study, weights: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """SiDMACIB's capacities for every option and reduction, with and without friction.

    A reduction by weights has one set of rows for each model and mesh that gave the weights.
    """
    for sample in study.interlocking:
        joint, followed = study.joint(sample), detailed(study.models_of_whole(sample))
        directions = [Direction(e) for e in study.eccentricities]
        weights_by_source = {
            source: values
            for source, values in pure_shear_weights(study, weights, sample).items()
            if source[0] in followed
        }
        strengths: dict[tuple[float, ...], list[tuple[str, str, float]]] = {}
        for reduction, (source, values) in product(
            study.sidmacib.reductions, weights_by_source.items()
        ):
            strength = REDUCTIONS[reduction](joint, values)
            strengths.setdefault(strength, []).append((reduction, *source))
        for strength, uses in strengths.items():
            for (name, option), friction in product(study.sidmacib.options.items(), (False, True)):
                kind = f"{name}-{'friction' if friction else 'frictionless'}"
                model = Sidmacib(
                    joint, option.contact_option(), strength, friction, study.sidmacib.overload
                )
                points = capacities(model, directions)
                for (reduction, source_model, mesh), (ratio, point) in product(
                    uses, zip(study.eccentricities, points, strict=True)
                ):
                    yield {
                        "model": "sidmacib",
                        "variant": f"{kind}-{reduction}",
                        **_place(study, sample, mesh, ratio),
                        "shear_N": point.shear,
                        "torque_Nm": point.torque,
                        "load_N": point.load,
                        "option": name,
                        "friction": friction,
                        "reduction": reduction,
                        "weights_from": source_model,
                    }


def law_capacity(
    study: Study, name: str, sample: str, ratio: float, variant: str = REFERENCE
) -> LawCapacity:
    """The capacity of a sample at ``ratio``, e / a, by the law, the safe rule or a resistance.

    ValueError or `CapacityError` where the rule has no answer.
    """
    change = study.every_variant[variant]
    assembly = change.assembly(study.assembly)
    if (reason := MODELS[name].refusal(requirements(study, assembly, sample))) is not None:
        raise ValueError(reason)
    rules = {**RULES, **resistances(_reliability(study))}
    return rules[name](study.joint(sample, change), Direction(ratio), push=assembly.push)


def _reliability(study: Study) -> Reliability:
    """What the strengths of a study stand for, as the rules take it."""
    return Reliability(study.reliability.scatter, study.reliability.gamma_m)


def law_rows(study: Study) -> Iterator[dict[str, Any]]:
    """Capacities by the law, the safe rule and the resistances among the study's models.

    They have no mesh: their rows are the same at each. Where a rule refuses, ``error`` says why.
    """
    chosen = [name for name in study.models if name in LAWS]
    for name, sample, ratio in product(chosen, study.samples, study.eccentricities):
        if name not in study.models_of(sample):
            continue
        result: dict[str, Any] = dict.fromkeys(("load_N", "shear_N", "torque_Nm", "error"))
        try:
            known = law_capacity(study, name, sample, ratio)
            result |= {"load_N": known.load, "shear_N": known.shear, "torque_Nm": known.torque}
        except (CapacityError, ValueError) as error:
            result["error"] = str(error)
        for mesh in study.meshes:
            yield {
                "model": name,
                "variant": REFERENCE,
                **_place(study, sample, mesh, ratio),
                "first_failure_load_N": result["load_N"] if name == "law" else None,
                **result,
            }


def _place(study: Study, sample: str, mesh: float, ratio: float) -> dict[str, Any]:
    """The columns that say where a capacity belongs: sample, mesh and direction, as in `CASES`."""
    joint = study.joint(sample)
    return {
        "sample": sample,
        "locks": joint.locks,
        "mesh_m": mesh,
        "eccentricity_m": ratio * joint.a,
        "eccentricity_over_a": ratio,
        "case": case_name(sample, mesh, ratio),
    }


def published_rows(study: Study, published: Published) -> Iterator[dict[str, Any]]:
    """The paper's pure-shear capacities, for the samples that it has."""
    for sample in published.samples(study):
        locks = study.joint(sample).locks
        for mesh in study.meshes:
            value = published.dem_pure_shear(locks, mesh)
            values = {"sidmacib": published.numbers["limit_pure_shear"][locks], "3dec": value}
            for variant, shear in values.items():
                if shear is not None:
                    yield {
                        "model": "published",
                        "variant": variant,
                        **_place(study, sample, mesh, 0.0),
                        "shear_N": float(shear),
                        "torque_Nm": 0.0,
                        "load_N": float(shear),
                    }


def envelope_rows(study: Study) -> Iterator[dict[str, Any]]:
    """Vertices of the exact V-M envelopes of all options, every lock counting."""
    for sample, (name, option), friction in product(
        study.interlocking, study.sidmacib.options.items(), (False, True)
    ):
        joint = study.joint(sample)
        model = Sidmacib(joint, option.contact_option(), None, friction, study.sidmacib.overload)
        for number, (shear, torque) in enumerate(envelope(model).vertices, start=1):
            names = {"sample": sample, "option": name, "friction": friction, "vertex": number}
            yield {**names, "shear_N": float(shear), "torque_Nm": float(torque)}


def capacity_table(study: Study, cases: pd.DataFrame, weights: pd.DataFrame) -> pd.DataFrame:
    """Capacities of all models of the pieces, of SiDMACIB and the rules, and published ones."""
    of_cases = cases[[column for column in CAPACITY.columns if column in cases]]
    rows = [
        *sidmacib_rows(study, weights),
        *law_rows(study),
        *published_rows(study, read_published()),
    ]
    return pd.concat([of_cases, pd.DataFrame(rows, columns=list(CAPACITY.columns))])


def demand_rows(study: Study, given: DemandSection) -> Iterator[dict[str, Any]]:
    """Whether each sample carries the ``given`` load, as `multilock capacity` says."""
    reliability = _reliability(study)
    demand = Demand(given.shear or 0.0, given.torque or 0.0, given.eccentricity, reliability)
    asked = {
        "safe": joint_answers.MODELS["safe"],
        **joint_answers.resistances(reliability, decides=True),
    }
    decides = joint_answers.deciding(asked)
    for sample in study.samples:
        joint = study.joint(sample)
        direction, load = demand.direction(joint), demand.load(joint)
        push = study.assembly.push
        answer = joint_answers.answer_of(decides, asked[decides], joint, direction, push)
        found = joint_answers.joint_verdict(demand, joint, {decides: answer})
        yield {
            "sample": sample,
            "required_shear_N": load * direction.shear,
            "required_torque_Nm": load * direction.torque * joint.a,
            "carried": found.passes,
            "open": found.open,
            "factor": found.factor,
            "decides": found.decides or None,
            "verdict": str(found),
        }


def run(arguments: Arguments, inputs: Files, outputs: Files) -> None:
    """Write the capacities and the envelopes."""
    study, tables = Study.model_validate_json(arguments["study"]), read_tables(inputs)
    capacity = capacity_table(study, tables["cases"], tables["weights"])
    envelopes = pd.DataFrame(envelope_rows(study), columns=list(ENVELOPES.columns))
    made = {"capacity": capacity, "envelopes": envelopes}
    if study.demand is not None:
        rows = demand_rows(study, study.demand)
        made["demands"] = pd.DataFrame(rows, columns=list(DEMANDS.columns))
    write_tables(made, outputs)


if __name__ == "__main__":
    step(run)
