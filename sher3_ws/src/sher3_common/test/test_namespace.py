"""Names of topics and frames of a robot in a namespace of its own."""

import pytest
from sher3_common.namespace import NAMESPACE_VARIABLE, BadNamespace, in_graph, prefix, robot_name, use_namespace


@pytest.fixture(autouse=True)
def nowhere(monkeypatch):
    monkeypatch.setenv(NAMESPACE_VARIABLE, "")


def test_a_robot_without_a_namespace_is_sher3_and_has_no_prefix():
    assert (robot_name(), prefix()) == ("sher3", "")
    assert in_graph("/sher3/measured_js") == "/sher3/measured_js" and in_graph("/diagnostics") == "/diagnostics"


@pytest.mark.parametrize(("asked", "space"), [("left", "/left"), ("/left", "/left"), ("theatre/left", "/theatre/left")])
def test_a_namespace_moves_every_topic_but_the_transforms(asked, space):
    assert use_namespace(asked) == space
    assert prefix() == space.strip("/").replace("/", "_") + "_"
    moved = {name: in_graph(name) for name in ("/sher3/measured_js", "/diagnostics", "/joint_states", "/tf")}
    assert moved == {
        "/sher3/measured_js": f"{space}/measured_js",
        "/diagnostics": f"{space}/diagnostics",
        "/joint_states": f"{space}/joint_states",
        "/tf": "/tf",
    }


@pytest.mark.parametrize("asked", ["", "/", "a-b", "1st", "left//right", "x" * 25, "lëft"])
def test_what_is_no_namespace_is_refused(asked):
    with pytest.raises(BadNamespace):
        use_namespace(asked)
