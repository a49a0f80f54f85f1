"""The reason codes under the name that the control room uses; they live with the other shared words."""

from sher3_description.reasons import ACTION as ACTION
from sher3_description.reasons import TEXT as TEXT
from sher3_description.reasons import Action as Action
from sher3_description.reasons import Reason as Reason
