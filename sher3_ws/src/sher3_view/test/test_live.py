"""The live view: what the panel says, where the parts go, and that it is served on this machine alone."""

from __future__ import annotations

import json
import math
import socket
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sher3_common.samples import DiagnosticSample, JointSample, JoySample, PoseSample, TextSample, WrenchSample
from sher3_description import load_robot
from sher3_faults.requests import make_request
from sher3_kinematics import RobotKinematics
from sher3_view.errors import ExtraMissing
from sher3_view.live.mock_panel import FAULTS
from sher3_view.live.page import PROFILES, LivePage, pose_of, revolved
from sher3_view.live.plot import plot_svg, scale_for
from sher3_view.live.snapshot import Snapshot, fault_text
from sher3_view.scene import RobotState, Scene

ROBOT = load_robot()
KINEMATICS = RobotKinematics(ROBOT)
MS = 1_000_000
EFFECTS = {"backlash": ("delta_1", "tilt")}


def heard(**more):
    """A robot in front of us: 2 N along x of which the tare took 0.5 N, the tip 1 mm/s fast, the pedal half down."""
    snapshot = Snapshot.empty()
    samples = {
        "measured_js": JointSample(1000 * MS, (0.019, 0.0, 0.0, 0.1, 0.0)),
        "setpoint_js": JointSample(1000 * MS, (0.019004, 0.0, 0.0, 0.1, 0.0)),
        "force/measured_cf": WrenchSample(1000 * MS, (2.0, 0, 0, 0, 0, 0)),
        "pedal/measured": JoySample(1000 * MS, (0.5,), (0,)),
        "supervisor/status": TextSample(json.dumps({"state": "ENABLED", "first_fault": None})),
        "admittance/status": TextSample(json.dumps({"reason": "MOVING", "text": "motion is allowed"})),
        "admittance/settings": TextSample(json.dumps({"live": {"bias": [0.5, 0, 0, 0, 0, 0]}})),
        "motion/settings": TextSample(
            json.dumps({"regime": "free", "rcm": [0.2, 0.0, 0.1], "settings": {"free_speed": 0.005}})
        ),
    }
    for stamp, x in ((990, 0.2), (1000, 0.20001)):
        samples["measured_cp"] = PoseSample(stamp * MS, (x, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0))
        snapshot.take({name: (lambda s=sample: s) for name, sample in {**samples, **more}.items()})
    return snapshot


def test_the_snapshot_by_hand():
    snapshot = heard()
    assert snapshot.force == pytest.approx([1.5, 0, 0])
    quarter = PoseSample(1000 * MS, (0.20001, 0.0, 0.1), (0.0, 0.0, 2.0, 2.0))  # about z, not of unit length
    assert heard(measured_cp=quarter).force == pytest.approx([0, 1.5, 0])
    assert snapshot.speed == pytest.approx(0.001), "10 µm in 10 ms"
    assert snapshot.cap == 0.005 and snapshot.pedal == 0.5
    assert snapshot.remote_centre == (0.2, 0.0, 0.1)
    kind, error = snapshot.tracking()
    assert kind == "position" and error[0] == pytest.approx(4e-6)


def test_the_panel_says_it_in_units_of_the_person():
    text = heard().text(ROBOT, 1010 * MS)
    assert "### ENABLED\nmotion is allowed" in text
    assert "1.00 mm/s, cap 5" in text and "1.50 N" in text and "50%" in text
    assert "| delta_1 | 19.000 mm | 75% | 4.0 µm |" in text, "of a travel from -38 to 38 mm"
    assert "| roll | 5.730° |" in text


def test_old_samples_and_faults_are_said():
    fault = TextSample(json.dumps({"state": "FAULT", "first_fault": {"code": "WRENCH_STALE"}}))
    text = heard(**{"supervisor/status": fault}).text(ROBOT, 3000 * MS)
    assert "### FAULT" in text and "WRENCH_STALE" in text and "2.0 s old" in text
    assert "Waiting" in Snapshot.empty().text(ROBOT, 0)


def test_what_was_refused_stands_in_the_panel():
    refused = TextSample(json.dumps({"refused": {"error": "MotionRefused", "text": "move_jp: not enabled"}}))
    assert "Refused: move_jp: not enabled" in heard(**{"motion/status": refused}).text(ROBOT, 1010 * MS)
    assert "Refused" not in heard().text(ROBOT, 1010 * MS)


def test_a_fault_is_told_with_its_numbers_and_lost_cycles_are_added_up():
    fault = {"code": "WRENCH_STALE", "source": "force/measured_cf", "value": 0.02, "limit": 0.01, "unit": "s"}
    status = TextSample(json.dumps({"state": "FAULT", "reason": "WRENCH_STALE", "first_fault": fault}))
    snapshot = heard(**{"supervisor/status": status})
    for node, lost in (("sher3/pedal", 2), ("sher3/kinematics", 3), ("sher3/pedal", 4)):
        told = DiagnosticSample(0, node, 1, "", (("ticks", "500"), ("lost_cycles", str(lost))))
        snapshot.take({"diagnostics": lambda told=told: told})
    text = snapshot.text(ROBOT, 1010 * MS)
    assert "WRENCH_STALE force/measured_cf: 0.02 s, limit 0.01 s" in text and "| Cycles lost | 7 |" in text


def test_what_is_not_finite_is_not_shown():
    snapshot = heard(measured_js=JointSample(1000 * MS, (math.nan, 0.0, 0.0, 0.0, 0.0)))
    assert snapshot.position is None
    assert "DISABLED" not in heard(**{"supervisor/status": TextSample("no json")}).text(ROBOT, 1000 * MS)


@pytest.mark.parametrize("q", [(0, 0, 0, 0, 0), (0.004, -0.003, 0.001, -0.2, 0.005)])
def test_meshes_are_put_where_the_points_are(q):
    for part in Scene(KINEMATICS).moving(RobotState(q, (0.0, 0.0, 1.0))):
        if not np.isfinite(part.points).all():
            continue
        position, (w, x, y, z), length = pose_of(part)
        turned = Rotation.from_quat((x, y, z, w))
        if part.kind == "ball":
            assert position == pytest.approx(part.points[0])
            continue
        start = position - turned.apply([0, 0, length / 2]) if part.kind == "bar" else position
        assert start == pytest.approx(part.points[0], abs=1e-12)
        assert start + turned.apply([0, 0, length]) == pytest.approx(part.points[1], abs=1e-12)
        if part.kind == "bar":
            assert start + turned.apply([0.05, 0, 0]) == pytest.approx(part.points[2], abs=1e-9)


def test_bodies_have_the_size_of_their_profile():
    vertices, faces = revolved(PROFILES["arrow"])
    assert vertices[:, 2].min() == 0.0 and vertices[:, 2].max() == 1.0
    assert np.linalg.norm(vertices[:, :2], axis=1).max() == pytest.approx(2.6)
    assert faces.max() == len(vertices) - 1


def test_the_scale_of_a_plot_is_round():
    assert [scale_for(v) for v in (0.0, 0.1, 0.11, 1.5, 2.0, 7.0)] == [0.1, 0.1, 0.2, 2.0, 2.0, 10.0]
    svg = plot_svg(np.array([-20.0, 0.0]), np.array([0.0, 1.0]), "Force", "N", "#000")
    assert 'points="8.0,82.0 356.0,24.0"' in svg and "to 1 N" in svg


def test_every_button_asks_for_a_fault_that_exists():
    for request in FAULTS.values():
        assert make_request(**request).component == request["component"]


def test_a_missing_library_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(ExtraMissing, match=r"sher3\[view\]") as caught:
        LivePage(KINEMATICS, 8080, EFFECTS)
    assert caught.value.module == "viser" and caught.value.exit_code == 3


@pytest.mark.flaky(reruns=2)
def test_the_page_is_served_on_loopback_alone():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    page = LivePage(KINEMATICS, port, EFFECTS)
    try:
        page.show(heard(), 1000 * MS)
        page.mocks.show(True, True)
        page.show(heard(), 1010 * MS)
        page.mocks.show(False, False)
        assert page.url == f"http://127.0.0.1:{port}" and page.mocks.faults() == [] == page.mocks.exchanges()
        with socket.socket() as other:
            other.bind(("127.0.0.2", port)), other.listen()
        socket.create_connection(("127.0.0.1", port), 2.0).close()
    finally:
        page.close()


def test_a_fault_of_the_driver_tells_its_limit_once():
    """Its source is the driver's sentence."""
    source = "motor_driver: delta_1: 1.2e-05 m from where its commands add up to (limit 1.16e-05)"
    fault = {"code": "POSITION_LEFT", "source": source, "value": 1.2e-5, "limit": 1.16e-5, "unit": "m"}
    assert fault_text(fault) == f"POSITION_LEFT {source}"
    assert fault_text({**fault, "source": "delta_1"}) == "POSITION_LEFT delta_1: 1.2e-05 m, limit 1.16e-05 m"
