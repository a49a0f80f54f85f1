"""The plant: the SHER 3.0 as the recorded-run contract (version 1, section 3) models it, and what that leaves out.

The main objects are `Plant`, which advances one control period at a time under a node or a test, and `simulate`, which
computes a whole run under the host's law in one compiled call. Effects are values that both take: friction, backlash,
compliance, drift and others that the contract's model leaves out. The plant knows the base `PlantEffect` alone; each
effect stands on its page in `sher3_effects`.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_sim.closed_loop import Excitation as Excitation
    from sher3_sim.closed_loop import excitation as excitation
    from sher3_sim.closed_loop import simulate as simulate
    from sher3_sim.closed_loop import simulate_arrays as simulate_arrays
    from sher3_sim.effect import PlantEffect as PlantEffect
    from sher3_sim.effect import with_effects as with_effects
    from sher3_sim.errors import EffectError as EffectError
    from sher3_sim.errors import InputError as InputError
    from sher3_sim.parameters import PlantParameters as PlantParameters
    from sher3_sim.parameters import nominal_parameters as nominal_parameters
    from sher3_sim.plant import Plant as Plant
    from sher3_sim.replay import contact_wrench as contact_wrench
    from sher3_sim.replay import recorded_excitation as recorded_excitation
    from sher3_sim.replay import resimulate as resimulate
    from sher3_sim.scatter import RunScatter as RunScatter

__getattr__, __dir__ = lazy(
    __name__,
    {
        "closed_loop": ("Excitation", "excitation", "simulate", "simulate_arrays"),
        "effect": ("PlantEffect", "with_effects"),
        "errors": ("EffectError", "InputError"),
        "parameters": ("PlantParameters", "nominal_parameters"),
        "plant": ("Plant",),
        "replay": ("contact_wrench", "recorded_excitation", "resimulate"),
        "scatter": ("RunScatter",),
    },
)
