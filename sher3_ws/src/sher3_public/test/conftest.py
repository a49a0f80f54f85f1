"""A log of a drawn arm whose shoulder has more dry friction than its model, and the answer on it."""

import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

sys.path.extend(str(Path(__file__).parents[2] / room / "test") for room in ("sher3_chain", "sher3_machines"))


@pytest.fixture(scope="session")
def more():
    """Dry friction of the shoulder beside the model's, N m."""
    return 1.2


@pytest.fixture(scope="session")
def log(more):
    from drawn_arms import drawn_xml, logged  # here: the process that hands out tests reads this file, and needs none

    xml = drawn_xml(np.random.default_rng(6), joints=2)
    robot = ElementTree.fromstring(xml)
    (joint,) = [j for j in robot.iter("joint") if j.get("name") == "shoulder"]
    joint.set("frictionloss", str(float(joint.get("frictionloss")) + more))
    return replace(logged(ElementTree.tostring(robot, encoding="unicode"), 6), xml=xml)


@pytest.fixture(scope="session")
def answer(log):
    import sher3.gap as gap

    return gap.diagnose(log.xml, log.time, log.ctrl, log.qpos)
