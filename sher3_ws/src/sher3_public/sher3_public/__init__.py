"""The diagnosis of a gap in one call, on arrays in memory; people import it as `sher3.gap`."""

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

__getattr__, __dir__ = lazy(
    __name__,
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
