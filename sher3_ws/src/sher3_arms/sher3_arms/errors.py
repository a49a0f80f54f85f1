"""The errors of this package."""

from __future__ import annotations

from sher3_common import Sher3Error


class Unstable(Exception):
    """An arm with this fault cannot follow its motion: no record of it would be kept, and another one is drawn."""


class ArmsError(Sher3Error):
    """A robot that is not there, a kind of fault that is not known, or MuJoCo missing."""


class NeverStable(ArmsError):
    """No draw of a kind of fault lets the arm follow its motion and shows; the case is left out."""
