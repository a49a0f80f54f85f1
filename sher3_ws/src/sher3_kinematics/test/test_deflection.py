"""The deflection model: equilibrium, symmetry, known numbers, and a large-displacement solution that shares no code."""

import numpy as np
import pytest
from scipy.optimize import root
from scipy.spatial.transform import Rotation
from sher3_description import Robot
from sher3_kinematics import BadInput, Singular, Unreachable
from sher3_kinematics.deflection import DeltaDeflection, ball_centres
from sher3_kinematics.link_law import LinkLaw
from sher3_kinematics.tip_deflection import RIGID, ArmCompliance, LoadBeyondRange, TipDeflection

LINEAR = LinkLaw(1e-6, 1.0)
PAPER = LinkLaw(3.7e-6, 0.71, force_floor=0.0)


@pytest.fixture(scope="module")
def delta(robot: Robot) -> DeltaDeflection:
    return DeltaDeflection(robot, PAPER)


def disc(count: int = 2000, radius: float = 0.0275) -> np.ndarray:
    index = np.arange(count)
    r, angle = radius * np.sqrt((index + 0.5) / count), index * np.pi * (3 - np.sqrt(5))
    return np.column_stack((r * np.cos(angle), r * np.sin(angle), np.zeros(count)))


def test_link_law_is_odd_and_has_the_right_slopes() -> None:
    law = LinkLaw(3.7e-6, 0.71, factor=0.5)
    force = np.array([-50.0, -3.0, -0.1, 0.0, 0.1, 3.0, 50.0])
    assert np.abs(law.deflection(force) + law.deflection(-force)).max() == 0
    step = 1e-6
    slope = (law.deflection(force + step) - law.deflection(force - step)) / (2 * step)
    assert law.tangent(force) == pytest.approx(slope, rel=1e-6)
    assert law.deflection(50.0) == pytest.approx(0.5 * 3.7e-6 * 50.0**0.71, rel=1e-4)
    assert np.isfinite(law.tangent(0.0))
    assert np.isinf(PAPER.tangent(0.0))


def test_balls_are_on_their_circles(robot: Robot) -> None:
    base, platform = ball_centres(robot)
    assert np.linalg.norm(base, axis=1) == pytest.approx(np.full(6, robot.delta.base_radius))
    assert np.linalg.norm(platform, axis=1) == pytest.approx(np.full(6, robot.delta.platform_radius))
    pairs = np.linalg.norm(base[0::2] - base[1::2], axis=1)
    assert pairs == pytest.approx(np.full(3, robot.delta.leg_width))


def test_link_forces_balance_the_wrench(delta: DeltaDeflection) -> None:
    """Sum of forces and moments over the six links, written out without the gamma matrix."""
    rng = np.random.default_rng(1)
    for centre in disc(20):
        wrench = rng.normal(size=6)
        forces = delta.link_forces(centre, wrench)
        directions = delta.link_vectors(centre) / delta.link_length
        assert (forces[:, None] * directions).sum(axis=0) == pytest.approx(wrench[:3], abs=1e-12)
        moments = np.cross(delta.platform, forces[:, None] * directions)
        assert moments.sum(axis=0) == pytest.approx(wrench[3:], abs=1e-12)


def test_vectorised_equals_one_by_one(delta: DeltaDeflection) -> None:
    centres, wrench = disc(30), np.array([1.0, -2.0, 3.0, 0.1, 0.2, -0.3])
    together = delta.deflection(centres, wrench)
    assert together == pytest.approx(np.array([delta.deflection(c, wrench) for c in centres]), rel=1e-12)


def test_secant_and_tangent_compliance(robot: Robot) -> None:
    delta = DeltaDeflection(robot, LinkLaw(3.7e-6, 0.71))
    centre, wrench = np.array([0.01, -0.005, 0.0]), np.array([2.0, -3.0, 1.0, 0.2, 0.1, -0.4])
    secant = delta.compliance(centre, wrench)
    assert secant @ wrench == pytest.approx(delta.deflection(centre, wrench), rel=1e-12)
    assert np.abs(secant - secant.T).max() < 1e-15
    tangent, step = delta.compliance(centre, wrench, "tangent"), 1e-5
    columns = [
        (delta.deflection(centre, wrench + step * e) - delta.deflection(centre, wrench - step * e)) / (2 * step)
        for e in np.eye(6)
    ]
    assert np.abs(tangent - np.array(columns).T).max() < 1e-9


def test_known_numbers_of_the_linear_stage(robot: Robot) -> None:
    """1 um/N per link: 3.47, 3.47, 0.22 um/N and 0.0644, 0.0644, 0.0924 deg/(N m) at the centre."""
    compliance = DeltaDeflection(robot, LINEAR).compliance([0, 0, 0], np.zeros(6))
    assert np.diag(compliance)[:3] * 1e6 == pytest.approx([3.47, 3.47, 0.2247], rel=1e-3)
    assert np.degrees(np.diag(compliance)[3:]) == pytest.approx([0.0644, 0.0644, 0.0924], rel=1e-3)


def test_torsion_at_the_centre_is_the_closed_form(robot: Robot, delta: DeltaDeflection) -> None:
    """T_c = 2 a / (w s) (tau / (3 w s))^b / tau with s = R / L."""
    w, s, torque = robot.delta.leg_width, robot.delta.leg_offset / robot.delta.link_length, 0.7
    expected = 2 * PAPER.a / (w * s) * (torque / (3 * w * s)) ** PAPER.b / torque
    assert delta.torsional_compliance([0, 0, 0], torque) == pytest.approx(expected, rel=1e-12)


def test_torsion_does_not_depend_on_the_platform_radius(robot: Robot) -> None:
    """The paper calls its fall with r_p expected; in its own model T_c is exactly independent of r_p."""
    centres = disc(50)
    reference = DeltaDeflection(robot, PAPER).torsional_compliance(centres, 1.0)
    for radius in (0.025, 0.047):
        inner = np.sqrt(radius**2 - 0.02**2)
        outer = float(np.hypot(inner + robot.delta.leg_offset, 0.02))
        other = robot.replace({"delta.platform_radius": radius, "delta.base_radius": outer})
        moved = DeltaDeflection(other, PAPER).torsional_compliance(centres, 1.0)
        assert moved == pytest.approx(reference, rel=1e-11)


def test_parasitic_motion_vanishes_at_the_centre_only(delta: DeltaDeflection) -> None:
    shift, tilt = delta.parasitic_motion(np.zeros(3), 1.0)
    assert shift < 1e-15
    assert tilt < 1e-15
    shift, tilt = delta.parasitic_motion(disc(), 1.0)
    assert 15e-6 < shift.max() < 30e-6
    assert 0.03 < np.degrees(tilt.max()) < 0.06


def test_small_deflection_agrees_with_a_large_displacement_solution(robot: Robot) -> None:
    """Six linear springs between balls, equilibrium by a root finder on the deformed geometry."""
    delta = DeltaDeflection(robot, LINEAR)
    centre = np.array([0.006, -0.009, 0.0])
    links = delta.link_vectors(centre)
    base = delta.platform - links
    wrench = np.array([1.0, -2.0, 0.5, 0.05, -0.08, 0.1])

    def imbalance(x: np.ndarray) -> np.ndarray:
        rotation = Rotation.from_rotvec(x[3:]).as_matrix()
        arms = delta.platform @ rotation.T
        moved = arms + x[:3] - base
        length = np.linalg.norm(moved, axis=1)
        force = ((length - delta.link_length) / LINEAR.a)[:, None] * moved / length[:, None]
        return np.concatenate((wrench[:3] - force.sum(axis=0), wrench[3:] - np.cross(arms, force).sum(axis=0)))

    found = root(imbalance, np.zeros(6), tol=1e-13)
    expected = delta.deflection(centre, wrench)
    assert np.abs(imbalance(found.x)).max() < 1e-6
    assert np.abs(found.x - expected).max() < 2e-3 * np.abs(expected).max()


def test_parallel_links_are_singular(robot: Robot) -> None:
    narrow = robot.replace({"delta.leg_width": 1e-9})
    with pytest.raises(Singular) as caught:
        DeltaDeflection(narrow, LINEAR).deflection([0, 0, 0], [0, 0, 0, 0, 0, 1.0])
    assert 0 <= caught.value.distance < 1e-6


def test_out_of_reach_and_bad_shapes(delta: DeltaDeflection) -> None:
    with pytest.raises(Unreachable) as caught:
        delta.deflection([0.05, 0, 0], [0, 0, 1.0, 0, 0, 0])
    assert caught.value.distance > 0
    for bad in ([0, 0, 1.0], [np.nan] * 6):
        with pytest.raises(BadInput):
            delta.deflection([0, 0, 0], bad)
    with pytest.raises(BadInput):
        delta.torsional_compliance([0, 0, 0], 0.0)
    with pytest.raises(BadInput):
        delta.compliance([0, 0, 0], np.zeros(6), "chord")  # type: ignore[arg-type]
    with pytest.raises(BadInput):
        LinkLaw(-1.0, 0.71)


def test_arm_and_delta_are_in_series(robot: Robot) -> None:
    wrench = np.array([0.5, 1.0, -0.3, 0.001, 0.002, 0.003])
    q = np.array([0.002, -0.003, 0.001, 0.1, 0.002])
    both = TipDeflection(robot)(q, wrench)
    links, arm = TipDeflection(robot, arm=RIGID)(q, wrench), TipDeflection(robot, LinkLaw(1e-15, 1.0))(q, wrench)
    assert both == pytest.approx(links + arm, rel=1e-6)


def test_one_newton_sideways_moves_the_tip_by_a_quarter_of_a_millimetre(robot: Robot) -> None:
    """The paper's table has 230 to 320 um/N in y; our tip is 200 mm from P, the paper's grasp probably further."""
    moved = TipDeflection(robot)(np.zeros(5), [0, 1.0, 0, 0, 0, 0])
    assert 200e-6 < moved[1] < 320e-6
    assert moved[5] > 0


def test_load_beyond_the_sensor_is_refused(robot: Robot) -> None:
    with pytest.raises(LoadBeyondRange) as caught:
        TipDeflection(robot)(np.zeros(5), [0, 0, -17.5, 0, 0, 0])
    assert caught.value.component == "fz"
    assert (caught.value.value, caught.value.limit) == (pytest.approx(-17.5), 17.0)
    with pytest.raises(LoadBeyondRange):
        TipDeflection(robot)(np.zeros(5), [0, 0, 0, 0, 0, 0.2])


def test_compensation_is_first_order_exact(robot: Robot) -> None:
    """Commanding the corrected position puts the deflected tip within a thousandth of the deflection of its target."""
    model = TipDeflection(robot)
    q, wrench = np.array([0.002, -0.003, 0.001, 0.1, 0.002]), np.array([0.5, 1.0, -0.3, 0, 0, 0])
    target = model.kinematics.transform_tip_to_base(q)
    corrected = model.kinematics.inverse(model.compensated(q, wrench, target[:3, 3]), -target[:3, 2])
    reached = model.kinematics.transform_tip_to_base(corrected)[:3, 3] + model(corrected, wrench)[:3]
    assert np.abs(reached - target[:3, 3]).max() < 5e-3 * np.abs(model(q, wrench)[:3]).max()


def test_compiled_tip_deflection_is_the_vectorised_one(robot: Robot, workspace_q: np.ndarray) -> None:
    model, rng = TipDeflection(robot), np.random.default_rng(8)
    for q in workspace_q[:50]:
        wrench = rng.uniform(-1, 1, 6) * [3, 3, 3, 0.01, 0.01, 0.01]
        centre = model.kinematics.delta.forward(q[:3])
        lever = model.kinematics.transform_tip_to_base(q)[:3, 3] - centre
        assert model(q, wrench) == pytest.approx(model.at_point(centre, lever, wrench), rel=1e-9, abs=1e-15)


def test_singular_delta_is_reported_by_the_tip_too(robot: Robot) -> None:
    narrow = TipDeflection(robot.replace({"delta.leg_width": 1e-9}))
    with pytest.raises(Singular):
        narrow(np.zeros(5), [0, 1.0, 0, 0, 0, 0])


def test_rigid_arm_does_not_move() -> None:
    assert not RIGID.deflection(np.ones(6)).any()
    assert ArmCompliance().deflection(np.array([2.0, 0, 0, 0, 0, 0]))[0] == pytest.approx(30e-6)
