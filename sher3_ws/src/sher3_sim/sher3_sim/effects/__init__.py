"""The effects of the recorded-run contract, section 7: each a small object that changes one stage of the plant."""

from . import compliance, drift, friction, geometry, inertia, limit, lost_motion, periodic, scale, timing, wrench
from .base import EFFECTS as EFFECTS
from .base import Effect as Effect
from .base import Parameter as Parameter
from .base import with_effects as with_effects
from .files import effect_from_dict as effect_from_dict
from .files import effect_to_dict as effect_to_dict
from .files import load_effects as load_effects
from .files import save_effects as save_effects

FAMILIES = (timing, scale, limit, friction, inertia, periodic, lost_motion, compliance, geometry, drift, wrench)
"""The modules of the eleven families, in the order of the contract."""
