"""An arm of two links as an MJCF and as a URDF model, for tests of what is written of its links."""

from xml.etree.ElementTree import tostring

from sher3_chain.manipulator.bodies import bodies_of
from sher3_export.targets.mjcf.body import skeleton
from sher3_export.xml_file import parse_xml

MJCF = """<mujoco><asset><mesh name="looks" file="nowhere.stl"/></asset><worldbody><body name="upper" pos="0 0 1">
<joint name="shoulder" axis="0 1 0" pos="0.01 0 0"/><geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="2"/>
<body name="fore" pos="0.4 0 0"><joint name="elbow" axis="0 1 0"/><geom type="mesh" mesh="looks"/>
<inertial pos="0.15 0 0" mass="1" diaginertia="0.001 0.01 0.01"/>
</body></body></worldbody></mujoco>"""
URDF = """<robot name="r"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.2 0 0" rpy="0 0 0.3"/><mass value="2"/>
<inertia ixx="0.002" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="fore"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
<inertia ixx="0.001" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0"/>
<axis xyz="0 1 0"/></joint></robot>"""
MODELS = {"mjcf": (MJCF, "mujoco"), "urdf": (URDF, "robot")}


def tree_of(text):
    root = parse_xml(text, "mujoco" if "<mujoco" in text else "robot")
    return bodies_of(tostring(skeleton(root) if root.tag == "mujoco" else root, encoding="unicode"), "arm").tree
