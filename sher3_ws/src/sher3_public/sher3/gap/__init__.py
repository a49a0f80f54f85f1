"""Why a robot does not do what its simulation does: `diagnose(model, time, control, position, effort)`.

    import sher3.gap as gap

    print(gap.diagnose("robot.xml", time, control, position))

Nothing is written unless it is asked for; importing this takes no more than a face.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_public.answer import Answer as Answer
    from sher3_public.correcting import Corrected as Corrected
    from sher3_public.errors import InputError as InputError
    from sher3_public.lerobot import from_lerobot as from_lerobot
    from sher3_public.one_call import diagnose as diagnose
    from sher3_public.simulating import Replay as Replay
    from sher3_public.simulating import Replays as Replays
    from sher3_public.simulators.comparing import Comparison as Comparison
    from sher3_public.simulators.comparing import compare_simulators as compare_simulators
    from sher3_public.sysid import from_sysid as from_sysid

__all__ = [
    "Answer",
    "Comparison",
    "Corrected",
    "InputError",
    "Replay",
    "Replays",
    "compare_simulators",
    "diagnose",
    "from_lerobot",
    "from_sysid",
]

__getattr__, __dir__ = lazy(
    "sher3_public",
    {
        "answer": ("Answer",),
        "correcting": ("Corrected",),
        "errors": ("InputError",),
        "lerobot": ("from_lerobot",),
        "one_call": ("diagnose",),
        "simulating": ("Replay", "Replays"),
        "simulators.comparing": ("Comparison", "compare_simulators"),
        "sysid": ("from_sysid",),
    },
)
