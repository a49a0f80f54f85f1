"""The robot seen: its scene, a recording as one page, and the running robot in a browser.

The main object is the scene: named primitives (rods, bars, balls, an arrow) from a robot state, plain data without any
drawing. A `Film` is the scene along a recording; `page` writes it as one HTML file that opens without network.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_view.errors import ViewError as ViewError
    from sher3_view.film import Film as Film
    from sher3_view.film import film_of as film_of
    from sher3_view.page import write_page as write_page
    from sher3_view.scene import Primitive as Primitive
    from sher3_view.scene import RobotState as RobotState
    from sher3_view.scene import Scene as Scene

__getattr__, __dir__ = lazy(
    __name__,
    {
        "errors": ("ViewError",),
        "film": ("Film", "film_of"),
        "page": ("write_page",),
        "scene": ("Primitive", "RobotState", "Scene"),
    },
)
