"""The part of a record that only structures have: interfaces and blocks, and what counts."""

from dataclasses import dataclass, replace

from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.equilibrium import has_bonds
from sidmacib.mechanics.loads import Loads
from sidmacib.problem import Outcome
from sidmacib.quantities import rounded
from sidmacib.structure.analysis.forces import BlockRow, InterfaceRow, block_rows, interfaces_of
from sidmacib.structure.files.structure_file import notes_on, required_of
from sidmacib.structure.loads import free_weight
from workflow.case import StructureCase
from workflow.results import Record


@dataclass(frozen=True)
class StructurePart:
    """The names of a structure's case, which load counts, and interfaces and blocks.

    ``tilts``: whether gravity turns. ``counts``: which load does, the peak or the first failure,
    and ``because`` says why; both are None where the model does not say. ``given_peak_N`` and
    ``given_first_failure_N``: on the cells of the file, where the rest is from smaller ones.
    ``required_N``: how much of the load is to be carried, if the description says.
    ``mesh_error``: of the load that counts, over it, and ``first_failure_mesh_error``; None where
    no other mesh was solved.
    ``first_interface``: whose bond fails first. ``bonded``: whether there are bonds. ``note``: what
    the answer rests on, and ``input_notes``: what looks wrong in the description, or is left to
    defaults, both in words.
    """

    structure: str
    load: str
    tilts: bool = False
    counts: str | None = None
    because: str | None = None
    weight_N: float | None = None
    required_N: float | None = None
    given_peak_N: float | None = None
    given_first_failure_N: float | None = None
    first_interface: str | None = None
    mesh_error: float | None = None
    first_failure_mesh_error: float | None = None
    nodes: int | None = None
    bonded: bool | None = None
    note: str | None = None
    input_notes: str | None = None
    interfaces: tuple[InterfaceRow, ...] = ()
    blocks: tuple[BlockRow, ...] = ()

    @classmethod
    def without_result(cls, case: StructureCase) -> "StructurePart":
        """The names of ``case``, and what is to be carried."""
        found = cls(case.subject.structure, case.subject.load)
        if not case.subject.demands:
            return found
        try:
            return replace(found, required_N=required_of(case.subject.description))
        except ValueError:  # of no structure
            return found

    @classmethod
    def of(
        cls, case: StructureCase, assembly: Assembly, loads: Loads, outcome: Outcome
    ) -> "StructurePart":
        """The names of ``case``, and what its outcome says."""
        counts, given, errors = outcome.counts, outcome.given, outcome.mesh_errors
        return cls(
            case.subject.structure,
            case.subject.load,
            tilts=loads.raised.axis is not None,
            counts=None if counts is None else counts.name,
            because=None if counts is None else counts.why,
            weight_N=rounded(free_weight(assembly)),
            required_N=required_of(case.subject.description, assembly),
            given_peak_N=given and rounded(given.peak),
            given_first_failure_N=given and rounded(given.first),
            first_interface=next((assembly.faces[face].name for face in outcome.broken_at), None),
            mesh_error=errors.peak if counts is None or counts.peak else errors.first,
            first_failure_mesh_error=errors.first,
            nodes=len(assembly.nodes.area),
            bonded=has_bonds(assembly) or (counts is not None and counts.dry),
            note="; ".join(outcome.notes) or None,
            input_notes="; ".join(notes_on(case.subject.description, assembly)) or None,
            interfaces=interfaces_of(assembly, outcome),
            blocks=block_rows(assembly, outcome),
        )

    @staticmethod
    def balance(share: float) -> float:
        """The unbalanced ``share`` without the noise of processors."""
        return float(f"{share:.1e}")


PART = StructurePart
StructureRecord = Record[StructurePart]
