"""Unmodelled effects, one page each: data sheet, signature, admissibility and form in the simulator.

`library()` are the pages of the robot by id, `plants()` their forms in the plant. An effects file lists effects of the
plant; `to_effects` turns the causes of a verdict into them.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_effects.effects_file import load_effects as load_effects
    from sher3_effects.effects_file import save_effects as save_effects
    from sher3_effects.effects_file import to_effects as to_effects
    from sher3_effects.page import Page as Page
    from sher3_effects.page import Part as Part
    from sher3_effects.registry import add_library as add_library
    from sher3_effects.registry import computed as computed
    from sher3_effects.registry import every as every
    from sher3_effects.registry import library as library
    from sher3_effects.registry import pages as pages
    from sher3_effects.registry import plants as plants

__getattr__, __dir__ = lazy(
    __name__,
    {
        "effects_file": ("load_effects", "save_effects", "to_effects"),
        "page": ("Page", "Part"),
        "registry": ("add_library", "computed", "every", "library", "pages", "plants"),
    },
)
