"""The section of a study that moves a structure in time by many ground motions."""

from collections.abc import Iterator
from typing import Annotated, Any, Self

from pydantic import Field, WithJsonSchema, model_validator

from sidmacib.quantities import Number, one_of
from sidmacib.reading import Section, Some, Text
from sidmacib.structure.shaking import UNITS
from workflow.schema.sections import Name

OWN = "ground"  # name of the motion in the file itself
AFTER = 2.0  # s after a record, in which what is about to fall does
SECONDS = Number(above=0, unit="s")
_Records = Annotated[
    dict[Name, dict[str, Any]],
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}),
]


class EarthquakeSection(Section):
    """A structure whose load acts in time, moved by records at several factors, to 2 s after each.

    ``file``: of `multilock assembly`, beside the configuration. ``records``: files in place of its
    ground motion, which may be patterns such as records/*.txt; without them, that motion itself.
    ``unit``: of their accelerations, as in the file. ``factors``: on all accelerations.
    """

    file: Annotated[str, Some] | None = None
    description: Annotated[dict[Text, Any], Some] | None = None
    records: _Records = Field(default_factory=dict)
    unit: Annotated[str, one_of(UNITS)] | None = None
    factors: Annotated[tuple[Annotated[float, Number(above=0, at_most=100)], ...], Some] = (1.0,)

    @model_validator(mode="after")
    def _apart(self) -> Self:
        if len({f"{each:g}" for each in self.factors}) < len(self.factors):
            raise ValueError("factors: must differ in their first six digits")
        return self

    def described(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """The name of each record, and the description with it as the ground's motion."""
        whole = self.description or {}
        if not self.records:
            yield OWN, whole
        for name, values in self.records.items():
            load = whole["load"]
            (own,) = load["ground"]
            kept = {key: own[key] for key in ("direction", "scale") if key in own}
            ground = [{**kept, "accelerogram": values}]
            long = max(SECONDS.read(load["duration"]), values["time"][-1] + AFTER)
            yield name, {**whole, "load": {**load, "ground": ground, "duration": long}}
