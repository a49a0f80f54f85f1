"""Errors of the challenge."""

from sher3_common.errors import Sher3Error


class ChallengeError(Sher3Error):
    """A challenge cannot be built or run as asked."""
