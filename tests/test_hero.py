"""The moving picture of README.md."""

import pytest

from studies.published import pictures


@pytest.fixture(scope="module")
def film() -> pictures.Film:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pictures, "MESH", 0.02)
        return pictures.film()


def test_it_names_the_lock_that_fails_first_and_goes_on_behind_the_peak(
    film: pictures.Film,
) -> None:
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
