"""How a view can fail."""

from __future__ import annotations

from sher3_common import Sher3Error


class ViewError(Sher3Error):
    """A recording has nothing to show, or the page cannot be written."""


class ExtraMissing(Sher3Error):
    """A view needs a library that is installed with an extra.

    Attributes:
        module: The library that is missing.
    """

    exit_code = 3

    def __init__(self, module: str, extra: str = "view") -> None:
        super().__init__(
            f"this view needs the library {module}", remedy=f"install the extra: pip install 'sher3[{extra}]'"
        )
        self.args = (module, extra)
        self.module = module
