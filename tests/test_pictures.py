"""The moving picture of README.md, and the sketch of a joint."""

import re
from xml.etree import ElementTree

import pytest

from analysis.drawing import PICTURE, sketch
from sidmacib.joint import Joint
from studies.published import pictures


@pytest.fixture(scope="module")
def film() -> pictures.Film:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "MESH", 0.02)
        return pictures.film()


def test_it_names_the_lock_that_fails_first_and_goes_behind_the_peak(film: pictures.Film) -> None:
    words = list(dict.fromkeys(words for _, words in film.frames()))
    assert words[0] == "The load rises: all bonds are whole"
    assert any(each.endswith("lock 2 is the first to fail") for each in words)
    assert words[-2].endswith("the peak")
    assert words[-1].startswith("Behind the peak")


def test_what_is_shown_rises_to_the_peak_and_loses_bonds_behind_it(film: pictures.Film) -> None:
    points = [point for point, _ in film.frames()]
    loads = [point.load for point in points]
    top = loads.index(max(loads))
    assert loads[: top + 1] == sorted(loads[: top + 1])
    bonds = [int(point.state.bonded.sum()) for point in points]
    assert bonds == sorted(bonds, reverse=True)
    assert bonds[-1] < bonds[top]


SVG = "{http://www.w3.org/2000/svg}"


def test_the_picture_of_the_readme_is_the_sketch_of_the_published_joint() -> None:
    assert PICTURE.read_text() == sketch(Joint(5))


@pytest.mark.parametrize("locks", [2, 5])
def test_every_lock_has_its_number_and_every_piece_three_faces(locks: int) -> None:
    root = ElementTree.fromstring(sketch(Joint(locks)))
    words = [each.text for each in root.iter(f"{SVG}text")]
    assert sorted(words) == sorted([*map(str, range(1, locks + 1)), "V", "M = V e"])
    faces = [each for each in root.iter(f"{SVG}polygon") if each.get("stroke")]
    assert len(faces) == 3 * (1 + 2 * locks)  # lower body, and a lock and a column for each


def test_all_that_is_drawn_is_within_the_frame() -> None:
    root = ElementTree.fromstring(sketch(Joint(3, a=0.1, H=0.2)))
    left, top, width, height = map(float, str(root.get("viewBox")).split())
    for shape in (*root.iter(f"{SVG}polygon"), *root.iter(f"{SVG}polyline")):
        for u, v in re.findall(r"([-\d.]+),([-\d.]+)", str(shape.get("points"))):
            assert left <= float(u) <= left + width and top <= float(v) <= top + height
