"""What may break in the SHER 3.0, and how far its tip travels before it stops.

A `FaultRequest` names a component and one of the `KINDS` of faults; the `FaultInjector` of the plant process does what
it asks to the mock devices. `TravelBudget` computes from the settings alone how far the tip travels after each
`FaultClass`.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_faults.braking import Braking as Braking
    from sher3_faults.braking import braking_of as braking_of
    from sher3_faults.budget import GUARDED as GUARDED
    from sher3_faults.budget import BudgetExceeded as BudgetExceeded
    from sher3_faults.budget import TravelBudget as TravelBudget
    from sher3_faults.errors import FaultRefused as FaultRefused
    from sher3_faults.fault_classes import FaultClass as FaultClass
    from sher3_faults.injector import FaultInjector as FaultInjector
    from sher3_faults.kinds import KINDS as KINDS
    from sher3_faults.kinds import Kind as Kind
    from sher3_faults.requests import FaultRequest as FaultRequest
    from sher3_faults.requests import make_request as make_request
    from sher3_faults.requests import parse_request as parse_request

__getattr__, __dir__ = lazy(
    __name__,
    {
        "braking": ("Braking", "braking_of"),
        "budget": ("BudgetExceeded", "GUARDED", "TravelBudget"),
        "errors": ("FaultRefused",),
        "fault_classes": ("FaultClass",),
        "injector": ("FaultInjector",),
        "kinds": ("KINDS", "Kind"),
        "requests": ("FaultRequest", "make_request", "parse_request"),
    },
)
