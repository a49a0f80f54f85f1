"""The live monitor: at the floor beside a healthy plant, a warning where the gap is, quiet once the effect is known."""

import json
import math

import pytest
from sher3_common.samples import JointSample
from sher3_effects import plants
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.live.monitor import HELD, TOPICS, Monitor
from simulated import ROBOT, samples

FRICTION = plants()["coulomb_friction"]("delta_2", force=1.5)


def judged(effects=(), known=(), label="sweep", skip=lambda topic, sample: False):
    (run,) = rehearse(ROBOT, [(excite(label, ROBOT), 0)], effects, scatter=None)
    monitor = Monitor(ROBOT, known)
    for topic, sample in samples(run):
        if not skip(topic, sample):
            monitor.feed(topic, sample)
    return {(s.stage, s.actuator): s for s in monitor.judge()}


def test_a_healthy_plant_is_at_the_floor():
    found = judged()
    assert len(found) == 26
    assert {k: s.ratio for k, s in found.items() if s.level} == {}


def test_friction_shows_where_it_is_and_nowhere_else():
    found = judged([FRICTION])
    assert found["motor_mechanics", "delta_2"].level == 2
    assert [k for k, s in found.items() if s.level] == [("motor_mechanics", "delta_2")]


def test_a_known_effect_is_no_gap():
    found = judged([FRICTION], known=[FRICTION])
    assert found["motor_mechanics", "delta_2"].ratio < 3.0
    assert found["motor_mechanics", "delta_2"].gap < 0.3 * judged([FRICTION])["motor_mechanics", "delta_2"].gap


def test_late_commands_show_in_transport():
    found = judged([plants()["command_delay"]("all", delay=1e-3)])
    assert found["transport", "delta_1"].level == 2
    assert not found["controller", "delta_1"].level


HOLE = 1_700_000_000_000_000_000 + 1500 * 2_000_000


def test_a_lost_sample_is_bridged():
    found = judged(skip=lambda topic, sample: topic == "measured_js" and sample.stamp == HOLE)
    assert len(found) == 26
    assert {k: s.ratio for k, s in found.items() if s.level} == {}


def test_a_long_hole_in_the_window_gives_no_answer():
    assert judged(skip=lambda topic, sample: topic != "setpoint_js" and 0 <= sample.stamp - HOLE < 10**8) == {}


def test_memory_is_bounded():
    monitor = Monitor(ROBOT, window=0.1)
    for k in range(10_000):
        monitor.feed("measured_js", JointSample(k * 2_000_000, (0.0,) * 5))
    assert monitor.held <= HELD / ROBOT.control_period
    assert monitor.judge() == []


@pytest.mark.graph
def test_the_node_publishes_once_a_second():
    from rclpy.node import Node
    from sher3_gap.live.gap_monitor_node import TOPIC, GapMonitorNode, judged_json
    from sher3_runtime import Graph
    from sher3_runtime.ports import NODE_OPTIONS, advertise, on_tick

    (run,) = rehearse(ROBOT, [(excite("sweep", ROBOT), 0)], [FRICTION], scatter=None)
    by_tick = {}
    for topic, sample in samples(run, 900):
        by_tick.setdefault(sample.stamp, []).append((topic, sample))
    rows = list(by_tick.values())

    class Robot(Node):
        def __init__(self, **options):
            super().__init__("robot", **{**NODE_OPTIONS, **options})
            self.publish = {t: advertise(self, t) for t in TOPICS}
            self.count = 0
            on_tick(self, self.tick)

        def tick(self, stamp):
            if self.count < len(rows):
                for topic, sample in rows[self.count]:
                    self.publish[topic](sample._replace(stamp=stamp))
            self.count += 1

    with Graph(middleware=False) as graph:
        graph.add(Robot)
        lines = []
        graph.add(GapMonitorNode, ROBOT, window=1.0, say=lambda *judged: lines.append(json.loads(judged_json(*judged))))
        probe = graph.probe(TOPIC)
        graph.step(880)
        names = {s.name for s in probe.samples[TOPIC]}
        assert "gap/motor_mechanics/delta_2" in names
        worst = max((s for s in probe.samples[TOPIC] if s.values), key=lambda s: float(dict(s.values)["ratio"]))
        assert worst.name == "gap/motor_mechanics/delta_2" and worst.level == 2
        assert math.isfinite(float(dict(worst.values)["gap"]))
        assert len(lines[-1]["stages"]) == 26 and lines[-1]["stamp"] % 10**9 == 0
        (row,) = [r for r in lines[-1]["stages"] if (r["stage"], r["actuator"]) == ("motor_mechanics", "delta_2")]
        assert row["level"] == 2 and row["ratio"] == pytest.approx(row["gap"] / row["floor"])
