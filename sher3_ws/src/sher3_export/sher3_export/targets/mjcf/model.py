"""MuJoCo: joint attributes, a second joint for play and compliance, attributes of the joint's actuators."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar
from xml.etree.ElementTree import Element, SubElement

from sher3_effects.page import NOISE

from sher3_export.changes import Change
from sher3_export.targets.links import INERTIAL, WANTED, WrongLinks
from sher3_export.targets.mjcf import motor
from sher3_export.targets.mjcf.body import (
    body_around,
    class_value,
    controlled,
    frames_around,
    in_frames,
    inside,
    moved,
    payloads_on,
    set_inertial,
    skeleton,
    together,
)
from sher3_export.targets.mjcf.numbers import write_noise, write_range
from sher3_export.targets.mjcf.tendon import at_motor
from sher3_export.targets.target import NOT_GIVEN, Row, XmlTarget, field
from sher3_export.xml_file import elements, number, numbers, parents, written

STEP = 0.002
"""MuJoCo's own time step where a model states none, s."""
LIGHT = 1e-3
"""Armature of a joint that only plays or bends, as a share of that of the motor's side: light enough not to matter,
heavy enough for the solver."""
LEAST = 1e-4
"""Armature, kg or kg m^2, of a motor's side that has none: without inertia of its own it cannot cross a gap."""
DUST = 1e-9
"""Mass and inertia of the motor's own body beside its armature, kg and kg m^2: MuJoCo refuses none at all."""
WATER = 1000.0
"""MuJoCo's own density of a geom that states none, kg/m^3."""
PLACE = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")
"""Attributes of a body that place it in its parent."""
SPARE = 2
"""Samples of a delayed actuator beyond delay over time step."""
LAG = "filterexact"
"""Dynamics of an actuator that is a first-order lag; the time constants of two of them add."""
SERVOS = ("position", "intvelocity")
"""Elements whose control is a place, with gains kp and kv."""
ACTUATORS = ("motor", "position", "velocity", "intvelocity", "general", "damper", "dcmotor", "pid")
"""Elements under <actuator> that may drive a joint."""


class Mjcf(XmlTarget):
    """A MuJoCo model; attributes that come from <default> classes are read there and written at the joint."""

    name, root_tag, suffix = "mjcf", "mujoco", "xml"
    refuses: ClassVar[Mapping[str, str]] = NOT_GIVEN
    apply_at_motor = at_motor

    def __init__(self, root: Element) -> None:
        super().__init__(root)
        self._sliding: dict[tuple[str, str], float] = {}
        self.links = WrongLinks(root, skeleton)

    def text(self, remarks: Sequence[str]) -> str:
        """Return the model with remarks as a comment on top, and its links changed together."""
        for name, inertia in self.links.changed().items():
            set_inertial(self.body(name), inertia)
        return super().text([*remarks, *self.links.remarks()])

    def apply(self, change: Change) -> str:
        """Write a change at its joint with its interval; return why it cannot be written, or nothing."""
        reason = super().apply(change)
        if not reason:
            write_range(self.root, change)
        return reason

    def all_joints(self) -> Sequence[Element]:
        """Return hinges and slides of the bodies."""
        return [x for body in elements(self.root, "body") for x in inside(body, "joint")]

    def nominal(self) -> dict[str, dict[str, float]]:
        """Return what joints have, classes of <default> included, and the gains of their servos."""
        named = {constant: self.fields[constant] for constant in ("coulomb", "viscous", "inertia")}
        return {
            name: {constant: self._inherited(joint, attribute) for constant, attribute in named.items()}
            | self._gains_of(name)
            for name, joint in self.joints.items()
        }

    def _gains_of(self, joint: str) -> dict[str, float]:
        """Stiffness and damping of the position actuator on a joint, at the joint; nothing without one."""
        servo = next((x for x in self._actuators(joint) if x.tag == "position"), None)
        if servo is None:
            return {}
        gear = numbers(servo.get("gear") or self._class_value(servo, "gear"), "1")[0] ** 2
        return {"stiffness": gear * self._inherited(servo, "kp", 1.0), "damping": gear * self._inherited(servo, "kv")}

    def stiffness(self, joint: str) -> float:
        """Return kp of the position actuator on a joint."""
        gains = [self._inherited(x, "kp", 1.0) for x in self._actuators(joint) if x.tag == "position"]
        return gains[0] if gains else 0.0

    def place(self, change: Change) -> Element | None:
        """Return the joint of a change, or the body of a link and of a payload."""
        on_link = change.constant.startswith(("link", "payload"))
        return self.body(change.joint) if on_link else self.joints.get(change.joint)

    def _add(self, joint: Element, attribute: str, change: float) -> str:
        total = self._inherited(joint, attribute) + change
        joint.set(attribute, written(max(total, 0.0)))
        return "" if total >= 0.0 else f"{attribute} would be {total:.4g}; set to zero, the rest is not expressed"

    def _offset(self, change: Change, joint: Element) -> str:
        """A constant force is an actuator without control: bias -offset."""
        actuators = self.root.find("actuator")
        actuators = SubElement(self.root, "actuator") if actuators is None else actuators
        name = f"{change.joint}_{change.effect}"
        standing = next((x for x in actuators if x.get("name") == name), None)
        if standing is not None:
            return field(standing, "biasprm", number(standing.get("biasprm")) - change.value)
        law = {"gainprm": "0", "biastype": "affine", "biasprm": written(-change.value)}
        SubElement(actuators, "general", {"name": name, "joint": change.joint, "ctrllimited": "false", **law})
        return ""

    def _weight(self, change: Change, joint: Element) -> str:
        """A share of the weight is gravity compensation of the body, where no other joint carries the body's load."""
        body = body_around(self.root, joint)
        below = [x for child in inside(body, "body") for x in child.iter("joint")]
        if below or len([*inside(body, "joint")]) > 1:
            return "the weight behind this joint is carried by other joints too"
        for part in body.iter("body"):
            part.set("gravcomp", written(number(part.get("gravcomp")) - change.value))
        return ""

    def _coulomb(self, change: Change, joint: Element) -> str:
        self._sliding[change.joint, change.effect] = change.value
        return self._add(joint, "frictionloss", change.value)

    def _static(self, change: Change, joint: Element) -> str:
        """Friction at rest takes that in motion of the same cause along into its own law."""
        sliding = self._sliding.get((change.joint, change.effect), 0.0)
        inertia = motor.inertia_at(self.root, change.joint) or self._inherited(joint, "armature")
        if reason := motor.at_rest(self.root, change, sliding, self.step, inertia):
            return reason
        return self._add(joint, "frictionloss", -sliding)

    def _drive(self, change: Change, joint: Element) -> str:
        actuators = self._actuators(change.joint)
        for actuator in actuators:
            if actuator.tag in SERVOS:
                self._scale(actuator, change, ("kp", "kv"))
            elif actuator.tag == "velocity":
                self._scale(actuator, change, ("kv",))
            else:
                gear = numbers(actuator.get("gear") or self._class_value(actuator, "gear"), "1")
                actuator.set("gear", written(gear[0] * (1.0 + change.value), *gear[1:]))
        return self._needs(actuators)

    def _gains(self, change: Change, gains: Sequence[str]) -> str:
        servos = self._servos(change.joint)
        for servo in servos:
            self._scale(servo, change, gains)
        return self._needs(servos)

    def _scale(self, actuator: Element, change: Change, gains: Sequence[str]) -> None:
        """Multiply gains of an actuator; of a <position> kp is one and kv is none where they are not stated."""
        for gain in gains:
            default = 0.0 if gain == "kv" and actuator.tag in SERVOS else 1.0
            actuator.set(gain, written(self._inherited(actuator, gain, default) * (1.0 + change.value)))

    def _delay(self, change: Change, actuators: Sequence[Element]) -> str:
        for actuator in actuators:
            delay = self._inherited(actuator, "delay") + change.value
            actuator.set("delay", written(delay))
            actuator.set("nsample", str(math.ceil(delay / self.step) + SPARE))
        return self._needs(actuators)

    @property
    def step(self) -> float:
        """Return the time step of the model, s."""
        option = self.root.find("option")
        return number(None if option is None else option.get("timestep"), STEP)

    def _lag(self, change: Change, joint: Element) -> str:
        """A first-order lag is an activation: `timeconst` of a position servo, a filter on any other force."""
        actuators = self._actuators(change.joint)
        for actuator in actuators:
            if actuator.tag == "position":
                actuator.set("timeconst", written(self._inherited(actuator, "timeconst") + change.value))
            elif actuator.tag in ("motor", "general") and actuator.get("dyntype", "none") in ("none", LAG):
                before = number(actuator.get("dynprm")) if actuator.get("dyntype") == LAG else 0.0
                actuator.tag = "general"
                actuator.set("dyntype", LAG)
                actuator.set("dynprm", written(before + change.value))
            else:
                return f"<{actuator.tag}> has a dynamics of its own"
        return self._needs(actuators)

    def _limit(self, change: Change, joint: Element) -> str:
        actuators = self._actuators(change.joint)
        for actuator in actuators:
            actuator.set("forcerange", written(-change.value, change.value))
            actuator.set("forcelimited", "true")
        return self._needs(actuators)

    def _zero(self, change: Change, joint: Element) -> str:
        """The reading is larger by the offset: at the drawn configuration the joint reads it."""
        degrees = self._degrees() and joint.get("type", "hinge") == "hinge"
        joint.set("ref", written(number(joint.get("ref")) + (math.degrees(change.value) if degrees else change.value)))
        return ""

    def _rest(self, change: Change, joint: Element) -> str:
        degrees = self._degrees() and joint.get("type", "hinge") == "hinge"
        return field(joint, "springref", math.degrees(change.value) if degrees else change.value)

    def body(self, place: str) -> Element | None:
        """Return the body of a name, or the body that a joint of that name moves; one without a name by its number."""
        named = {x.get("name", f"body{n}"): x for n, x in enumerate(elements(self.root, "body"), start=1)}
        found = named.get(place)
        return body_around(self.root, self.joints[place]) if found is None and place in self.joints else found

    def _link(self, change: Change, body: Element) -> str:
        """A link is its body with all that is fixed to it; mass and inertia of each keep their centre."""
        scale, compiler = 1.0 + change.value, self.root.find("compiler")
        shapes = compiler is not None and compiler.get("inertiafromgeom") == "true"
        for part in together(body):
            own = None if shapes else part.find("inertial")
            if own is not None:
                for name in ("mass", "diaginertia", "fullinertia"):
                    if name in own.attrib:
                        own.set(name, written(*(scale * x for x in numbers(own.get(name), "0"))))
            for geom in inside(part, "geom") if own is None else []:
                stated = geom.get("mass") or self._class_value(geom, "mass")
                name = "density" if stated is None else "mass"
                geom.set(name, written(scale * self._inherited(geom, name, WATER)))
        return ""

    def _payload(self, change: Change, body: Element) -> str:
        """A body of its own with the mass of a point, at the joint of the link until its centre is known."""
        if change.value <= 0.0:
            return "no mass is zero or less"
        anchor, number_ = body.find("joint"), len(payloads_on(self.root, change.joint)) + 1
        name = f"{change.joint}_payload" + (f"_{number_}" if number_ > 1 else "")
        added = SubElement(body, "body", {"name": name})
        added.set("pos", "0 0 0" if anchor is None else anchor.get("pos", "0 0 0"))
        inertial = {"pos": "0 0 0", "mass": written(change.value), "diaginertia": written(*[DUST] * 3)}
        SubElement(added, "inertial", inertial)
        return ""

    def _centre(self, change: Change, body: Element) -> str:
        """The centre is that of the payload that was written last."""
        payloads = payloads_on(self.root, change.joint)
        return moved(payloads[-1], change) if payloads else "the payload itself could not be written"

    def _shift(self, change: Change, joint: Element) -> str:
        """A joint that sits elsewhere than drawn: the body moves by as much in its own frame."""
        body = body_around(self.root, joint)
        if any(name in body.attrib for name in PLACE[1:]):
            return "the body is turned against its parent; shift its pos along its own axes by hand"
        return moved(body, change)

    def _backlash(self, change: Change, joint: Element) -> str:
        half = change.value / 2.0
        limit = math.degrees(half) if self._degrees() and joint.get("type", "hinge") == "hinge" else half
        standing = self.joints.get(f"{change.joint}_play")
        if standing is not None:
            limit += numbers(standing.get("range"), "0 0")[1]
            standing.set("range", written(-limit, limit))
            return ""
        return self._second(change, joint, "play", {"range": written(-limit, limit), "limited": "true"})

    def _compliance(self, change: Change, joint: Element) -> str:
        if change.value <= 0.0:
            return "no spring has a compliance of zero or less"
        standing = self.joints.get(f"{change.joint}_spring")
        before = 0.0 if standing is None else 1.0 / number(standing.get("stiffness"))
        stiffness = 1.0 / (before + change.value)  # springs one behind the other
        law = {"stiffness": written(stiffness), "damping": written(self.step * stiffness)}
        if standing is None:
            return self._second(change, joint, "spring", law)
        standing.attrib.update(law)
        return ""

    def _noise(self, change: Change, joint: Element) -> str:
        return write_noise(self.root, change, {x.get("name") for x in self._actuators(change.joint)})

    def _second(self, change: Change, joint: Element, what: str, law: Mapping[str, str]) -> str:
        """Part motor from load: a body of the motor's own takes the joint, and the load hangs on it by a second one.

        Two parallel joints of one body would do, but MuJoCo takes the joints of a body that only slides for orthogonal.
        """
        motor = self._inherited(joint, "armature") or LEAST
        joint.set("armature", written(motor))
        above = parents(self.root)
        load = body_around(self.root, joint)
        world = above[load]
        place = {name: load.attrib.pop(name) for name in PLACE if name in load.attrib}
        of_class = {"childclass": load.attrib["childclass"]} if "childclass" in load.attrib else {}
        body = Element("body", {"name": f"{change.joint}_{what}_motor", **place, **of_class})
        world[list(world).index(load)] = body
        SubElement(body, "inertial", {"pos": "0 0 0", "mass": written(DUST), "diaginertia": written(*[DUST] * 3)})
        before = [*inside(load, "joint")]
        for held in before[: before.index(joint) + 1]:
            frames = frames_around(above, held)
            above[held].remove(held)
            body.append(in_frames(held, frames))
        same: dict[str, str] = {
            str(name): joint.attrib[name] for name in ("type", "axis", "pos", "class") if name in joint.attrib
        }
        plain = {"armature": written(LIGHT * motor), "frictionloss": "0", "stiffness": "0", "damping": "0"}
        second = Element("joint", {"name": f"{change.joint}_{what}", **same, **plain, "limited": "false", **law})
        load.insert(0, in_frames(second, frames))
        body.append(load)
        return ""

    def _actuators(self, joint: str) -> list[Element]:
        return [
            x
            for block in self.root.findall("actuator")
            for x in block
            if x.get("joint") == joint and x.tag in ACTUATORS and controlled(x)
        ]

    def _servos(self, joint: str) -> list[Element]:
        return [x for x in self._actuators(joint) if x.tag in SERVOS]

    def _needs(self, actuators: Sequence[Element]) -> str:
        return "" if actuators else "the model has no such actuator on this joint"

    def _degrees(self) -> bool:
        compiler = self.root.find("compiler")
        return compiler is None or compiler.get("angle", "degree") == "degree"

    def _inherited(self, element: Element, attribute: str, default: float = 0.0) -> float:
        """Return an attribute of an element, or what the classes of <default> say of it."""
        own = element.get(attribute)
        return number(own if own is not None else self._class_value(element, attribute), default)

    def _class_value(self, element: Element, attribute: str) -> str | None:
        return class_value(self.root, element, attribute)

    rows: ClassVar[Mapping[str, Row]] = {
        "coulomb": Row("frictionloss", _coulomb),
        "static": Row("dcmotor without input, lugre", _static),
        "stribeck": Row("dcmotor without input, lugre", lambda to, change, _: motor.falling(to.root, change)),
        "viscous": Row("damping", lambda to, change, joint: to._add(joint, "damping", change.value)),
        "inertia": Row("armature", lambda to, change, joint: to._add(joint, "armature", change.value)),
        "offset": Row("actuator without control", _offset),
        "weight": Row("gravcomp, for the last joint", _weight),
        "drive": Row("gear, or kp and kv", _drive),
        "delay": Row("delay, nsample", lambda to, change, _: to._delay(change, to._actuators(change.joint))),
        "servo": Row("kp and kv", lambda to, change, _: to._gains(change, ("kp", "kv"))),
        "servo_position": Row("kp", lambda to, change, _: to._gains(change, ("kp",))),
        "servo_velocity": Row("kv", lambda to, change, _: to._gains(change, ("kv",))),
        "servo_delay": Row("delay, nsample", lambda to, change, _: to._delay(change, to._servos(change.joint))),
        "lag": Row("filterexact, timeconst", _lag),
        "limit": Row("forcerange", _limit),
        "zero": Row("ref", _zero),
        **dict.fromkeys(
            motor.COGGING,
            Row("dcmotor without input, cogging", lambda to, change, _: motor.cogging(to.root, change)),
        ),
        **dict.fromkeys(
            ("arm", "hanging"),
            Row("dcmotor without input, cogging of one period", lambda to, change, _: motor.weight(to.root, change)),
        ),
        "backlash": Row("a body of the motor's own and a second joint", _backlash),
        "compliance": Row("a body of the motor's own and a second joint", _compliance),
        "spring": Row("stiffness", lambda to, change, joint: to._add(joint, "stiffness", change.value)),
        "rest": Row("springref", _rest),
        "link": Row("inertial, or mass or density of the geoms", _link),
        **dict.fromkeys(INERTIAL, WANTED),
        "payload": Row("a body of its own", _payload),
        **dict.fromkeys(("payload_x", "payload_y", "payload_z"), Row("a body of its own", _centre)),
        **dict.fromkeys(("shift_x", "shift_y", "shift_z"), Row("pos of the body", _shift)),
        **dict.fromkeys(NOISE, Row("numeric, noise of a sensor", _noise)),
    }
