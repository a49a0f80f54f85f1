"""Settings as parameters, and the lines of the log, by hand."""

from sher3_view.live.log_lines import ERROR, WARNING, LogLines
from sher3_view.live.parameters import SETTABLE, parameters_of

LAW = {
    "live": {"version": 2, "speed_scale": 0.5, "linear_gain": 0.001, "angular_gain": 5.0, "lock": 0, "bias": [0.0] * 6},
    "settings": {"pedal": {"mode": "proportional", "release": 0.05}, "motion": {"speed": 0.5}},
}
MOTION = {"version": 1, "regime": "free", "settings": {"speed": 0.5, "deflection_compensation": False}}


def test_live_settings_have_plain_names_and_the_others_that_of_their_part():
    assert parameters_of(LAW, MOTION) == {
        "speed_scale": 0.5,
        "linear_gain": 0.001,
        "angular_gain": 5.0,
        "regime": "free",
        "law.pedal.mode": "proportional",
        "law.pedal.release": 0.05,
        "motion.speed": 0.5,
        "motion.deflection_compensation": False,
    }
    assert parameters_of({}, {}) == {}
    assert SETTABLE["speed_scale"].text.format(0.25) == "speed_scale 0.25"


def test_a_fault_and_a_refusal_are_told_once():
    lines = LogLines()
    fault = {"code": "WRENCH_STALE", "source": "force", "value": 0.02, "limit": 0.01, "unit": "s"}
    status = {"state": "FAULT", "first_fault": fault, "refused": {"text": "enable refused"}}
    told = lines.status("supervisor/status", status)
    assert [(line.level, line.name, line.text) for line in told] == [
        (WARNING, "sher3.supervisor", "enable refused"),
        (ERROR, "sher3.supervisor", "FAULT: WRENCH_STALE force: 0.02 s, limit 0.01 s"),
    ]
    assert lines.status("supervisor/status", status) == []
    assert lines.status("supervisor/status", {"state": "DISABLED", "first_fault": None, "refused": None}) == []
    assert len(lines.status("supervisor/status", status)) == 2, "a second time is a new one"


def test_what_a_node_complains_about_is_told_until_it_changes():
    lines = LogLines()
    assert lines.diagnostic("sher3/pedal", 0, "ok") == []
    assert [(line.level, line.name) for line in lines.diagnostic("force sensor: link", 2, "silent")] == [
        (ERROR, "sher3.force sensor")
    ]
    assert lines.diagnostic("force sensor: link", 2, "silent") == []
    assert lines.diagnostic("supervisor: state", 2, "FAULT") == [], "its status says more"
