"""Plant of the SHER 3.0 with a door for unmodelled effects."""

from . import compile_cache as compile_cache  # isort: skip
from .effects import EFFECTS as EFFECTS
from .effects import Effect as Effect
from .effects import effect_from_dict as effect_from_dict
from .effects import effect_to_dict as effect_to_dict
from .effects import load_effects as load_effects
from .effects import save_effects as save_effects
from .effects import with_effects as with_effects
from .errors import EffectError as EffectError
from .errors import InputError as InputError
from .parameters import PlantParameters as PlantParameters
from .parameters import nominal_parameters as nominal_parameters
from .plant import Plant as Plant
from .plant import Reading as Reading
from .replay import contact_wrench as contact_wrench
from .replay import recorded_excitation as recorded_excitation
from .replay import resimulate as resimulate
from .scatter import RunScatter as RunScatter
from .simulate import Excitation as Excitation
from .simulate import excitation as excitation
from .simulate import simulate as simulate
from .simulate import simulate_arrays as simulate_arrays
