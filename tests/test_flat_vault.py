"""The flat vault of Abeille's blocks in `studies/flat_vault`."""

from collections import Counter

import pytest

from sidmacib.errors import InfeasibleError, UnboundedError
from sidmacib.mechanics.limit import limit_load
from sidmacib.mechanics.static import static_peak
from sidmacib.structure.blocks import Block
from sidmacib.structure.files.structure_file import read_structure, structure_of
from sidmacib.structure.loads import free_weight
from studies.flat_vault.geometry import FILES, LEAN, SIDE, THICKNESS, description, text


@pytest.mark.parametrize("blocks", FILES)
def test_the_files_are_what_the_geometry_writes(blocks: int) -> None:
    assert FILES[blocks].read_text() == text(blocks)


def test_each_block_is_a_truncated_tetrahedron_that_touches_four_others() -> None:
    assembly = read_structure(FILES[5]).assembly
    blocks = {piece.name: piece for piece in assembly.pieces if piece.name.startswith("block")}
    assert len(blocks) == 25
    for block in blocks.values():
        assert isinstance(block, Block)
        assert block.reentrant is None
        # The integral over its height of (a + 2 z tan) (a - 2 z tan).
        volume = SIDE**2 * THICKNESS - 4 * LEAN**2 * THICKNESS**3 / 3
        assert block.volume == pytest.approx(volume, rel=1e-6)
    ends = [
        assembly.pieces[end].name for face in assembly.faces for end in (face.below, face.above)
    ]
    assert {Counter(ends)[each] for each in blocks} == {4}


def test_the_vault_carries_more_the_rougher_its_joints_and_opens_as_it_slides() -> None:
    problem = read_structure(FILES[3])
    weight = free_weight(problem.assembly)
    static, limit = static_peak(*problem).peak.load, limit_load(*problem, friction=True).load
    assert static / weight == pytest.approx(0.3628, abs=5e-4)  # as docs/howto/structure.md says
    assert static < limit == pytest.approx(0.3930 * weight, abs=5e-4 * weight)
    rough = structure_of(description(3, friction=0.8))
    assert limit_load(*rough, friction=True).load > 2 * limit


def test_smooth_joints_do_not_hold_it_and_a_rigid_frame_holds_any_load() -> None:
    with pytest.raises(InfeasibleError):
        limit_load(*structure_of(description(3, friction=0.3)), friction=True)
    framed = description(3)
    for block, value in framed["blocks"].items():
        value["fixed"] = not block.startswith("block")
    with pytest.raises(UnboundedError):
        limit_load(*structure_of(framed), friction=True)
