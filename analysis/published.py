"""The paper's numbers, and the samples of a study that they can be compared with."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from sidmacib.joint.joint import Side
from workflow.schema import Study
from workflow.schema.joint import AssemblySection


@dataclass(frozen=True)
class Published:
    """The paper's numbers, see published.yaml."""

    numbers: dict[str, Any]

    def covers(self, study: Study, sample: str) -> bool:
        """Whether the paper has numbers for ``sample``, loaded as in ``study``.

        Strength, locks, their blocks, failure, the cut of the body, the hold-down and the load must
        be the paper's; sizes may differ, as it gives a * b only, and friction may, see
        `as_printed`. Its numbers are for
        e = 0.
        """
        joint, numbers = study.joint(sample), self.numbers["sample"]
        return (
            math.isclose(joint.T0, numbers["T0"])
            and joint.locks in self.numbers["weights"]
            and joint.first is Side.UPPER
            and not joint.different
            and study.assembly == AssemblySection()
            and 0.0 in study.eccentricities
        )

    def as_printed(self, study: Study, sample: str) -> bool:
        """Whether the dry faces of ``sample`` have the friction that the paper prints."""
        return math.isclose(
            study.joint(sample).dry.friction, self.numbers["sample"]["friction"], abs_tol=1e-12
        )

    def samples(self, study: Study) -> dict[str, int]:
        """Names and numbers of locks of the study's samples that the paper has."""
        return {n: s.locks for n, s in study.samples.items() if self.covers(study, n)}

    def dem_pure_shear(self, locks: int, mesh: float) -> float | None:
        """Published peak V at e = 0, in N, if there is one for this mesh (m)."""
        printed = self.numbers["dem_pure_shear"][locks]
        return next((float(v) for m, v in printed.items() if math.isclose(m, mesh)), None)


def read_published() -> Published:
    """The published numbers."""
    return Published(yaml.safe_load(Path(__file__).with_name("published.yaml").read_text()))
