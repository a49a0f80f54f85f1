"""What a target is: it takes changes one by one, or says why it cannot, and gives its text."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple
from xml.etree.ElementTree import Element

from sher3_export.changes import Change
from sher3_export.errors import ExportError
from sher3_export.xml_file import write_xml, written


def each(said: Mapping[str, str]) -> dict[str, str]:
    """Return constant -> what is said of it, from a table whose keys are several names in a row."""
    return {name: text for names, text in said.items() for name in names.split()}


NOT_GIVEN = each(
    {
        "arm hanging": "a weight at an arm is mass and centre of a link, which the verdict does not give",
        "load_loss": "friction does not follow the load here; that of the mean load was written",
        "ratio": "the load encoder is no part of the joint",
    }
)
"""Constants that hardly any target has a field for, and why."""


class Target(ABC):
    """A model or configuration that causes are written into.

    Class attributes:
        name: as the command line has it.
        suffix: of a file of it.
        fields: constant -> the field that takes it, as the documentation shows it.
        refuses: constant -> why this target has no field for it.
    """

    name: ClassVar[str]
    suffix: ClassVar[str] = "yaml"
    fields: ClassVar[Mapping[str, str]] = {}
    refuses: ClassVar[Mapping[str, str]] = {}

    @abstractmethod
    def apply(self, change: Change) -> str:
        """Write a change; return why it cannot be written, or nothing."""

    def apply_at_motor(self, change: Change, travel: Mapping[str, float]) -> str:
        """Write a change of a motor that moves several joints; return why it cannot be written, or nothing.

        Args:
            change: by the motor's own travel.
            travel: joint of the model -> travel of the motor per travel of the joint.
        """
        return f"{self.name} has no field for a motor that moves several joints; --to mjcf has"

    @abstractmethod
    def text(self, remarks: Sequence[str]) -> str:
        """Return the model with remarks as a comment on top."""


class Row(NamedTuple):
    """Where a constant stands in a model, and what writes it there.

    Attributes:
        field: as the documentation shows it.
        write: of the target, a change and the element it is written at; returns why it cannot be, or nothing.
    """

    field: str
    write: Callable[[Any, Change, Element], str]


class XmlTarget(Target):
    """A model in XML.

    Class attributes:
        root_tag: name of its root element.
        rows: constant -> its field and what writes it; `fields` are those.

    Attributes:
        root: of the model, changed in place.
    """

    root_tag: ClassVar[str]
    rows: ClassVar[Mapping[str, Row]]

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        cls.fields = {constant: row.field for constant, row in cls.rows.items()}

    def __init__(self, root: Element) -> None:
        self.root = root
        self.joints = {x.attrib["name"]: x for x in self.all_joints() if "name" in x.attrib}
        if not self.joints:
            remedy = "give the file that holds the joints, each with a name"
            raise ExportError("the model has no joint with a name", value="0 joints", remedy=remedy)

    @abstractmethod
    def all_joints(self) -> Sequence[Element]:
        """Return the joints of the model."""

    @property
    def step(self) -> float | None:
        """Return the time step that the model states, s; None where it states none."""
        return None

    @abstractmethod
    def nominal(self) -> dict[str, dict[str, float]]:
        """Return joint -> constant -> what the model says of friction, damping and rotor inertia, SI units."""

    def apply(self, change: Change) -> str:
        """Write a change at its joint; return why it cannot be written, or nothing."""
        if change.constant not in self.rows:
            return self.refuses.get(change.constant, f"{self.name} has no field for it")
        joint = self.place(change)
        if joint is None:
            return f"the model has nothing of this name (joints: {', '.join(list(self.joints)[:12])}); see --joint"
        if change.over_stiffness and not (stiffness := self.stiffness(change.joint)):
            return "given in units of the servo's stiffness, which the model does not state"
        elif change.over_stiffness:
            scaled: dict[str, Any] = {"value": change.value * stiffness, "unit": "N*m" if change.unit == "rad" else "N"}
            change = Change(**{**change.__dict__, **scaled})
        return self.rows[change.constant].write(self, change, joint)

    def place(self, change: Change) -> Element | None:
        """Return the element that a change is written at; default the joint of its name."""
        return self.joints.get(change.joint)

    def stiffness(self, joint: str) -> float:
        """Return the stiffness of the servo on a joint, N/m or N m/rad; default 0, not stated."""
        return 0.0

    def text(self, remarks: Sequence[str]) -> str:
        """Return the model with remarks as a comment on top."""
        return write_xml(self.root, remarks)


def field(attribute: Element, name: str, value: float) -> str:
    """Set an attribute to a number; return nothing: it could be written."""
    attribute.set(name, written(value))
    return ""
