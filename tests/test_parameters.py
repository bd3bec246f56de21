"""The table of a joint's parameters: what each row of it must have."""

import pytest

from sidmacib.joint import Direction, HoldDown, Joint
from sidmacib.joint.parameters import PARAMETERS, SIZES, with_parameters
from sidmacib.quantities import Length
from sidmacib.rule import law, spans_of

BENDS = with_parameters(Joint(5), {"young": 1e10, "hold_down": HoldDown.pressure(1e4)})
# The law has been tested with all of these words, and a first failure comes before any fracture
# energy is used up.
ALL_COVERED = {"upper_body", "failure", "fracture_energy"}


@pytest.mark.parametrize("name", sorted(PARAMETERS.keys() - ALL_COVERED - {"hold_down"}))
def test_a_parameter_is_in_a_span_of_the_rule_or_refused_by_it(name: str) -> None:
    before = PARAMETERS[name].of(BENDS)
    other = with_parameters(BENDS, {name: 2 * before if before else 0.1})
    if spans_of(other) == spans_of(BENDS):
        with pytest.raises(ValueError, match=name):
            law(other, Direction(0.3))


def test_sizes_are_the_lengths_of_a_joint() -> None:
    assert [name for name, each in PARAMETERS.items() if each.kind == Length] == [*SIZES]


def test_a_slider_lies_within_the_range_of_its_parameter() -> None:
    for parameter in PARAMETERS.values():
        if parameter.slider and parameter.number:
            least, most, step, *unit = parameter.slider
            for value in (least or step, most):
                parameter.read(value * (unit[1] if unit else 1.0))
