"""Print the SROS 2 policy of the robot: what each node may publish and hear, read from the nodes themselves.

    python tools/sros2_policy.py > sher3_ws/src/sher3_bringup/sher3_bringup/security/policy.xml

Two enclaves: `/sher3` for the robot's own processes, `/sher3/operator` for who commands it from elsewhere.
"""

from __future__ import annotations

from xml.etree import ElementTree

from sher3_description import TOPICS
from sher3_runtime import Graph
from sher3_runtime.ports import ports

Tables = dict[str, tuple[set[str], set[str]]]


def robot_nodes() -> Tables:
    """Return the topics each node of the robot publishes and hears; the recorder hears everything."""
    from sher3_bringup.stepped_robot import SteppedRobot
    from sher3_bringup.terminal.status_news import SOURCES

    with Graph() as graph:
        SteppedRobot(graph)
        found = {node.get_name(): (set(ports(node).publishers), set(ports(node).subscriptions)) for node in graph.nodes}
    # `sher3 up` gives every process the diagnostics of its own timing.
    found = {name: (publishes | {"diagnostics"}, hears) for name, (publishes, hears) in found.items()}
    everything = set(TOPICS)
    recorder = {"recorder": ({"diagnostics"}, everything), "recorder_ears": (set(), everything)}
    return {**found, **recorder, "terminal": ({"diagnostics"}, set(SOURCES))}


def operator_node() -> Tables:
    """Return the same for an operator's node: it commands, and hears everything."""
    return {"operator": ({name for name in TOPICS if name.startswith("command/")}, set(TOPICS))}


def policy() -> str:
    """Return the policy as XML (SROS 2 policy version 0.2.0)."""
    root = ElementTree.Element("policy", version="0.2.0")
    enclaves = ElementTree.SubElement(root, "enclaves")
    for path, nodes in (("/sher3", robot_nodes()), ("/sher3/operator", operator_node())):
        enclave = ElementTree.SubElement(enclaves, "enclave", path=path)
        profiles = ElementTree.SubElement(enclave, "profiles")
        for name, (publishes, hears) in sorted(nodes.items()):
            profile = ElementTree.SubElement(profiles, "profile", ns="/sher3", node=name)
            for kind, topics in (("publish", publishes), ("subscribe", hears)):
                if topics:
                    group = ElementTree.SubElement(profile, "topics", {kind: "ALLOW"})
                    for topic in sorted(topics):
                        ElementTree.SubElement(group, "topic").text = TOPICS[topic].full_name
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


if __name__ == "__main__":
    print(policy(), end="")
