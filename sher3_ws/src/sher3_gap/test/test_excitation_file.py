"""An excitation as a file comes back as it was, and what is wrong with one is a sentence."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_common import FileError
from sher3_description import load_robot
from sher3_gap.excitation import excite
from sher3_gap.excitation.file import about_excitation, load_excitation, save_excitation

ROBOT = load_robot()


@pytest.fixture
def stored(tmp_path):
    return save_excitation(tmp_path / "sweep.yaml", excite("sweep", ROBOT), {"for": "backlash"})


def test_it_comes_back_as_it_was(stored):
    made, back = excite("sweep", ROBOT), load_excitation(stored, ROBOT)
    np.testing.assert_array_equal(back.position, made.position)
    np.testing.assert_array_equal(back.velocity, made.velocity)
    assert (back.name, back.posture, back.loads) == (made.name, made.posture, made.loads)
    assert about_excitation(stored) == {"for": "backlash"}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("sher3.excitation/1", "sher3.excitation/9", "is not an excitation: schema"),
        ("data: sweep.npz", "data: ../sweep.npz", "data must be named by its plain name"),
        ("period: 0.002", "period: 0.001", "control period"),
    ],
)
def test_a_wrong_header_is_named(stored, old, new, words):
    text = stored.read_text()
    assert old in text
    stored.write_text(text.replace(old, new))
    with pytest.raises(FileError, match=words):
        load_excitation(stored, ROBOT)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda x: x[:, :4], "wrong shape"),
        (lambda x: x[:1], "number of samples"),
        (lambda x: np.where(x == x, np.nan, x), "not finite"),
    ],
)
def test_wrong_samples_are_named(tmp_path, change, words):
    made = excite("sweep", ROBOT)
    path = save_excitation(
        tmp_path / "bad.yaml", replace(made, position=change(made.position), velocity=change(made.velocity))
    )
    with pytest.raises(FileError, match=words):
        load_excitation(path, ROBOT)
