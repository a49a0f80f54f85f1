"""The frames of a measurement, found from poses made with known ones."""

from dataclasses import replace

import numpy as np
import pytest
from arms import X, Z, machine, measured
from sher3_machines import MachineError
from sher3_static.arm.frames import fitted_view, frame_columns
from sher3_static.arm.kinematics import postures, transform
from sher3_static.arm.sight import PoseSight, hand_eye
from sher3_static.arm.view import ArmView

SIGHT = PoseSight()
FLOOR = np.repeat([1e-4, 1e-3], 3)


@pytest.fixture(scope="module")
def view():
    record = measured(np.zeros(6), n=30, noise=0.0)
    arm, q = machine().known.arm, record["joints"]
    return ArmView(np.zeros(30), arm, q, postures(arm, q), Z, X, SIGHT)


def moved(view, base=None, body=None):
    return replace(view, base=view.base if base is None else base, body=view.body if body is None else body)


def test_the_linear_start_finds_both_frames(view):
    base, body = hand_eye(view.postures.tip, view.pose)
    np.testing.assert_allclose(base, Z, atol=1e-9)
    np.testing.assert_allclose(body, X, atol=1e-9)


def test_noise_is_averaged_out():
    record = measured(np.zeros(6), n=200, noise=1e-4)
    run = np.zeros(200, dtype=int)
    found = fitted_view(machine().known.arm, record["joints"], record["poses"], run, FLOOR, SIGHT)
    np.testing.assert_allclose(found.base[:3, 3], Z[:3, 3], atol=1e-4)
    assert np.sqrt(np.mean(SIGHT.error(found.pose, record["poses"])[:, :3] ** 2)) == pytest.approx(1e-4, rel=0.1)


def test_columns_are_what_small_moves_of_the_frames_do(view):
    """The measuring frame moved by 1 um along y, and the body turned by 1 urad about its own z."""
    columns = frame_columns(view)
    shifted = transform([0.0, 1e-6, 0.0]) @ Z
    np.testing.assert_allclose(
        SIGHT.error(view.pose, moved(view, base=shifted).pose) / 1e-6, columns[:, :, 4], atol=1e-6
    )
    c, s = np.cos(1e-6), np.sin(1e-6)
    turned = X @ transform(rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    np.testing.assert_allclose(
        SIGHT.error(view.pose, moved(view, body=turned).pose) / 1e-6, columns[:, :, 8], atol=1e-5
    )


def test_a_turn_and_a_shift_seen_by_the_measuring_system(view):
    """A turn of one joint by 1 urad moves the body as the arm does; a shift of 1 um along x by that much."""
    q = view.joints.copy()
    q[:, 3] += 1e-6
    after = Z @ postures(view.arm, q).tip @ X
    np.testing.assert_allclose(
        SIGHT.error(view.pose, after) / 1e-6, view.turned(view.postures.axes[:, 3], view.place("j4")), atol=1e-5
    )
    along = np.tile([1.0, 0.0, 0.0], (30, 1))
    assert view.shifted(along)[0] == pytest.approx([*Z[:3, 0], 0.0, 0.0, 0.0])


def test_postures_without_a_turn_tell_no_frames():
    with pytest.raises(MachineError, match="do not tell the frames"):
        hand_eye(np.tile(np.eye(4), (10, 1, 1)), np.tile(Z @ X, (10, 1, 1)))
