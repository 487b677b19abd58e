"""Attributes that answer by their old names for one version."""

import pytest

from pushpressslide.core.path import ArcPath
from pushpressslide.core.pose import Pose2
from pushpressslide.core.renamed import Renamed


class Cart:
    wheels = 4
    tyres = Renamed("wheels", until="9.9")


def test_the_old_name_answers_and_names_the_new_one() -> None:
    text = r"Cart\.tyres: call it wheels; the old name goes in 9\.9"
    with pytest.warns(DeprecationWarning, match=text):
        assert Cart().tyres == 4
    with pytest.warns(DeprecationWarning, match=text):
        assert Cart.tyres == 4


def test_sections_of_a_path_answer_as_pieces() -> None:
    path = ArcPath(Pose2(0.0, 0.0, 0.0), ((0.0, 1.0), (2.0, 0.5)))
    with pytest.warns(DeprecationWarning, match="ArcPath.pieces: call it sections"):
        assert path.pieces == path.sections
