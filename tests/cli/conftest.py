"""Pages of small runs hold small films: how films look is judged in tests/rstar/film."""

import pytest

from surmount.rstar.film import run_films
from surmount.rstar.film.film import FilmConfig

SMALL = FilmConfig(width_px=64, height_px=48, fps=4)


@pytest.fixture(autouse=True, scope="module")
def _small_films():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run_films, "LARGE", (SMALL, SMALL))
        patch.setattr(run_films, "SMALL", (SMALL, SMALL))
        yield
