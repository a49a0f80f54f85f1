"""How a view can fail."""

from __future__ import annotations

from sher3_common import Sher3Error


class ViewError(Sher3Error):
    """A recording has nothing to show, or the page cannot be written."""


class ExtraMissing(Sher3Error):
    """The live view needs a library that is installed with the extra `view`.

    Attributes:
        module: The library that is missing.
    """

    exit_code = 3

    def __init__(self, module: str) -> None:
        super().__init__(
            f"the live view needs the library {module}", remedy="install the extra: pip install 'sher3[view]'"
        )
        self.args = (module,)
        self.module = module
