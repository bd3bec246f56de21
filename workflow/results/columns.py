"""Meanings of the columns of the study's tables, for readers; no job depends on them.

A column means the same in every table, and is explained once, in `MEANINGS`; `EXCEPTIONS` are the
few whose name has another meaning somewhere. Units are at the end of the names; a meaning gives the
unit of a column whose name does not.
"""

from collections.abc import Mapping, Sequence

from workflow.results import tables
from workflow.results.tables import Table

TABLES: tuple[Table, ...] = tuple(each for each in vars(tables).values() if isinstance(each, Table))
MORE: Mapping[str, Sequence[str]] = {  # columns of a table that may follow those it must have
    tables.MODELS.name: ("displacement_at_<share>_percent_m", "weight_lock<number>", "case"),
}
MEANINGS: Mapping[str, str] = {
    # which result it is
    "model": "name of the model",
    "variant": "name of the variant; `reference` is the one without changes",
    "sample": "name of the sample",
    "case": "name of the case without its variant: the same for all models and variants",
    "name": "name of the case",
    "locks": "number of locks of the joint",
    "mesh_m": "longest side of a cell of a face",
    "nodes": "where the contact nodes of a cell are: `centres`, `vertices` or `lobatto`",
    "eccentricity_m": "eccentricity e = M / V of the load; `inf` in pure torsion",
    "eccentricity_over_a": "e / a, where a is the length of a lock; `inf` in pure torsion",
    # loads
    "load_N": "largest load carried, along the path: √(V² + (M / a)²)",
    "peak_N": "largest load carried, whether it counts or not; empty for models without a peak",
    "counts": "which load `load_N` is: the `peak` or the `first failure`; empty if the model does "
    "not say",
    "because": "why the peak counts, or the first failure",
    "shear_N": "shear force V at `load_N`",
    "torque_Nm": "torque M at `load_N`",
    "failed_load_N": "smallest load known not to be carried",
    "first_failure_load_N": "load at which the first node reaches its strength",
    "load_over_T0": "`load_N` over the strength T0 of a lock",
    "mode": "failure mode: `bonds` break, pieces slide or overturn (`mechanism`, `rocking`), or "
    "`first failure` if the model stops there, or blocks are crushed (`crushing`)",
    # how good a result is
    "peak_spread": "the highest of the peaks that the static model found less the lowest, over the "
    "lowest, which is `peak_N`",
    "unbalanced_share": "largest force left on a piece, or moment over a, over the load",
    "mesh_error": "upper estimate of the difference between the load and its limit for ever finer "
    "meshes, over the load; that of the static model where the model has one mesh",
    "first_failure_mesh_error": "the same estimate as `mesh_error`, for the first failure",
    "static_load_N": "load of the static model for the same joint, nodes and load: its first "
    "failure where either model gives no peak",
    "difference_to_static": "relative difference of the load to the static model's; of first "
    "failures where either model gives no peak",
    "error": "reason why there is no result; empty if there is one",
    "versions": "the engine and its version",
    # locks
    "lock": "number of the lock; 1 is the first in +y",
    "block": "block that the lock belongs to: `upper` or `lower`",
    "weight": "weight of the lock: resultant shear on its inner face over the lock's strength",
    "mean_shear_ratio": "mean size of the shear stress on the lock's inner face, over the cohesion",
    "max_shear_ratio": "largest shear stress at a node of the lock's inner face, over the cohesion",
    "shear_x_N": "resultant shear along the lock, on the piece above its inner face",
    "shear_y_N": "resultant shear across the lock, on the piece above its inner face",
    "weight_sum": "sum of the weights of all locks",
    "weight_sum_floor": "`weight_sum` rounded down",
    "lower_weight_sum": "sum of the weights of the locks that belong to the lower block",
    "weight_lock<number>": "weight of each lock",
    # models side by side
    "friction_share": "share of V that reaches the lower block other than by its locks; empty in "
    "pure torsion",
    "given_load_N": "load at which models are compared: the first failure of the first of them, or "
    "its `load_N`",
    "displacement_at_<share>_percent_m": "displacement that the load does work on, at this share "
    "of `given_load_N`",
    # SiDMACIB
    "option": "option of SiDMACIB: where the contact points of a lock are",
    "friction": "whether SiDMACIB has friction along the locks",
    "reduction": "rule for the locks that count in SiDMACIB",
    "weights_from": "model that gave SiDMACIB the weights of the locks",
    "vertex": "number of the vertex, counter-clockwise from the smallest V",
    "misfit": "root mean square of the relative errors of SiDMACIB's loads against the model's",
    "largest_unsafe_error": "largest relative error where SiDMACIB overestimates the model's load; "
    "0 if nowhere",
    "largest_safe_error": "largest relative error where SiDMACIB underestimates the load; 0 if "
    "nowhere",
    "rank": "rank by `misfit` among the options and rules of a model, sample and mesh; 1 fits best",
    "directions": "number of directions that are compared",
    "largest_mesh_error": "largest `mesh_error` of the model's loads that are compared",
    "distance_over_a": "distance of the two contact points from the middle of a lock, over a, that "
    "fits best",
    "distance_m": "the distance of `distance_over_a`",
    "strength_per_lock_N": "mean strength of a lock that fits best",
    "locks_that_count": "`strength_per_lock_N` of all locks, as a number of locks at full strength",
    # joints
    "failure": "failure of inner faces: `brittle`, `softening` or `ductile`",
    "upper_body": "division of the upper body: `columns`, `joined` or `monolithic`",
    "young_Pa": "Young's modulus of the block; empty if the pieces are rigid",
    "stiffness_ratio": "E / (Kn b): Young's modulus of the block over normal stiffness of inner "
    "faces and width of a lock; empty if the pieces are rigid",
    "fracture_energy_J_m2": "work by which inner faces lose one of their strengths; for softening",
    # supports that move
    "answer": "model and what it answers; `none` where no model has an answer, see `note`",
    "reaction_N": "force of the structure on the support, along its movement",
    "reaction_Nm": "moment of the structure on the support, about the axis of its rotation",
    "movement_m": "displacement of the support",
    "movement_degrees": "rotation of the support",
    # samplings
    "sampling": "name of the sampling",
    "number": "number of the joint in its sampling, from 0",
    "push": "direction of the push: `+y`, on the face at lock 1, or `-y`",
    "a_over_b": "length over width of a lock",
    "h_over_b": "height over width of a lock",
    "H_over_b": "height of the upper main body over width of a lock",
    "shear_over_normal": "shear stiffness over normal stiffness of inner faces",
    "dry_over_inner": "normal stiffness of dry faces over that of inner faces",
    "pressure_over_cohesion": "pressure on the upper block over the cohesion; 0 under a plate",
    "plate": "whether a fixed plate holds the upper block down, and not a pressure",
    "energy_ratio": "fracture energy of inner faces over the energy stored when they fail",
    "first_failure": "load of the first failure by the static model, over T0, on the finer mesh",
    "peak": "peak by the static model, over T0, on the finer mesh",
    "peak_mesh_error": "the peak on the coarser mesh over that on the finer one, minus 1",
    "limit": "load by limit analysis, over T0, on the coarser mesh; of every `limited`th joint",
    # published and measured numbers
    "quantity": "name of the published number, which ends with its unit",
    "published": "the published number",
    "computed": "the computed number",
    "relative_difference": "computed minus published, over published; empty for a name or a 0",
    "absolute_difference": "computed minus published; empty for a name",
    "setting": "whether the sample is `as printed` in the paper or `not as printed`",
    "note": "further remarks",
    "specimen": "name of the specimen that was measured",
    "measured_shear_N": "shear force V that was measured",
    "measured_torque_Nm": "torque M that was measured",
    "measured_load_N": "load that was measured, along the path: √(V² + (M / a)²)",
    "difference": "`load_N` over `measured_load_N`, minus 1",
    # structures
    "structure": "name of the structure",
    "load": "name of the load",
    "blocks": "number of blocks that can move, and of parts that are cut out of them",
    "interfaces": "number of interfaces",
    "weight_N": "weight of the blocks that can move",
    "load_over_weight": "`load_N` over `weight_N`",
    "required_N": "load that is to be carried",
    "carried": "whether it is carried",
    "factor": "load that decides over `required_N`: that of the static model, or of limit analysis "
    "where that model has no answer; empty without an answer, or without a limit",
    "first_failure_factor": "first failure in the static model over `required_N`",
    "peak_factor": "peak in the static model over `required_N`",
    "limit_factor": "load of limit analysis over `required_N`",
    "governs": "whether it has the lowest factor of the structure's loads",
    "verdict": "verdict in words",
    "tilt_degrees": "angle by which gravity has turned at the load that counts; "
    "loads in N are empty where it turns",
    "peak_tilt_degrees": "angle at the last equilibrium, whether it counts or not",
    "static_tilt_degrees": "as `static_load_N`, of angles",
    "failed_tilt_degrees": "smallest angle known not to be carried",
    "first_failure_tilt_degrees": "angle at which the first node reaches its strength",
    "first_interface": "interface whose bond fails first",
    "most_used_interface": "interface with the largest `utilisation` at the load; empty where all "
    "are dry",
    "refused": "reason why the model refuses the structure; empty if it does not",
    "interface": "name of the interface: those of its two blocks",
    "kind": "kind of the interface: `inner` is bonded, `dry` is not, `locked` has condensed locks",
    "area_m2": "area of the interface",
    "cohesion_Pa": "cohesion of the interface",
    "tensile_strength_Pa": "tensile strength of the interface",
    "normal_N": "compression that the interface carries; negative in tension",
    "torsion_Nm": "moment about the normal of the interface, at its centroid",
    "bending_Nm": "size of the moment in the plane of the interface, at its centroid",
    "eccentricity": "distance of the resultant from the interface's centroid over that of the edge "
    "that way: 1 in a hinge; empty where no resultant acts",
    "utilisation": "1 at failure; bonded: strength used at the node that is used most; dry: the "
    "larger of `eccentricity` and of shear and torsion over what friction allows",
    "bonded_share": "part of the interface's area that is bonded",
    "fails_at": "part of the peak load at which the interface's first bond fails",
    "force_x_N": "x component of the resultant on the second block of the interface's name",
    "force_y_N": "y component of the resultant on the second block of the interface's name",
    "force_z_N": "z component of the resultant on the second block of the interface's name",
    "at_x_m": "x of the point where the resultant acts; empty where there is none",
    "at_y_m": "y of the point where the resultant acts; empty where there is none",
    "at_z_m": "z of the point where the resultant acts; empty where there is none",
    "fixed": "whether the block is fixed",
    "x_m": "x of the block's centroid",
    "y_m": "y of the block's centroid",
    "z_m": "z of the block's centroid",
    "motion": "motion of the block: `at the load`, or in the `mechanism`, for 1 m along the load; "
    "empty if the model does not compute it",
    "move_x_m": "displacement of the block along x",
    "move_y_m": "displacement of the block along y",
    "move_z_m": "displacement of the block along z",
    "turn_x": "rotation of the block about x, in rad",
    "turn_y": "rotation of the block about y, in rad",
    "turn_z": "rotation of the block about z, in rad",
}
_MOVED = {"variant": "name of the variant; `reference` is the structure as described"}
_NAMED = {"case": "name of the case"}
EXCEPTIONS: Mapping[str, Mapping[str, str]] = {
    tables.CAPACITY.name: {
        "model": "name of the model; `published` is the paper",
        "variant": "name of the variant; of SiDMACIB: option, friction and rule; of the paper: "
        "which of its models",
    },
    tables.VARIANTS.name: {
        "directions": "number of directions that the variant was run in",
        "option": "option of SiDMACIB that fits the variant best, without friction and by the rule "
        "`half`; empty with fewer than three directions",
    },
    tables.FIT.name: {"model": "name of the model that SiDMACIB is compared with"},
    tables.BEST_FIT.name: {"model": "name of the model that SiDMACIB is fitted to"},
    tables.ENVELOPES.name: {"shear_N": "V of the vertex", "torque_Nm": "M of the vertex"},
    tables.SAMPLINGS.name: {
        "friction": "friction coefficient of dry faces",
        "first_failure_mesh_error": "the first failure on the coarser mesh over that on the finer "
        "one, minus 1",
    },
    tables.MEASURED.name: {"number": "number of the measured load in the configuration, from 1"},
    tables.VALIDATION.name: {"friction": "friction coefficient of the sample's dry faces"},
    tables.STRUCTURES.name: {
        **_MOVED,
        **_NAMED,
        "nodes": "number of contact nodes",
        "load_N": "load that counts, see `counts`",
        "static_load_N": "load of the static model on the cells of the file, on which engines are; "
        "its first failure where that counts",
        "mesh_error": "upper estimate of the difference between the load or angle and its limit "
        "for ever smaller cells, over itself",
        "unbalanced_share": "largest force left on a block, or moment over the blocks' mean size, "
        "over the load",
        "difference_to_static": "relative difference of the load or angle to the static model's on "
        "the same cells",
    },
    tables.INTERFACES.name: {
        **_MOVED,
        **_NAMED,
        "friction": "friction coefficient of the interface",
        "shear_N": "shear force that the interface carries",
    },
    tables.BLOCKS.name: {
        **_MOVED,
        **_NAMED,
        "block": "name of the block, or of a part of one",
        "weight_N": "weight of the block",
    },
}


def meaning(table: Table, column: str) -> str:
    """The meaning of a ``column`` of a table; KeyError if it has none."""
    return EXCEPTIONS.get(table.name, {}).get(column) or MEANINGS[column]


def columns_of(table: Table) -> tuple[str, ...]:
    """All columns of a table, those that may follow as well."""
    return *table.columns, *MORE.get(table.name, ())
