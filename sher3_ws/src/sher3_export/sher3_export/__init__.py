"""Verdicts in the models of other simulators: MJCF, URDF, SDF, actuator configurations of Isaac Lab, plain YAML.

`export(verdict, target, model)` writes the causes into the user's model and lists what the target cannot express.
`check/` runs the exported model in MuJoCo on the recorded commands, `ranges` gives ranges for randomisation.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_export.changes import Change as Change
    from sher3_export.changes import NotExpressed as NotExpressed
    from sher3_export.changes import changes_of as changes_of
    from sher3_export.errors import ExportError as ExportError
    from sher3_export.writing import TARGETS as TARGETS
    from sher3_export.writing import Exported as Exported
    from sher3_export.writing import export as export

__getattr__, __dir__ = lazy(
    __name__,
    {
        "changes": ("Change", "NotExpressed", "changes_of"),
        "errors": ("ExportError",),
        "writing": ("TARGETS", "Exported", "export"),
    },
)
