"""ROS domains claimed for this process, so that two test runs on one machine do not hear each other.

A claim is an abstract AF_UNIX name. Such a name belongs to one network namespace, as the ports of a domain do, and it
disappears with the process, however the process ends.
"""

from __future__ import annotations

import itertools
import os
import socket
from collections.abc import Sequence

from sher3_common import Sher3Error

IN_PROCESS = range(1, 71)
"""Domains of graphs within a process; demo and benches have fixed ones, from 73 on."""
PROCESSES = range(101, 201)
"""Domains of graphs of several processes."""

_claims: dict[int, socket.socket] = {}
_places = itertools.count()


class NoDomainLeft(Sher3Error):
    """Every domain is claimed."""


def own_domain() -> int:
    """Return the domain of all graphs within this process; it is claimed at the first call and kept to the end.

    Raises:
        NoDomainLeft: Other processes have claimed all of `IN_PROCESS`.
    """
    mine = [domain for domain in _claims if domain in IN_PROCESS]
    return mine[0] if mine else claim_domain(IN_PROCESS)


def claim_domain(domains: Sequence[int]) -> int:
    """Claim and return the first free domain.

    The search starts at a domain that depends on the process and moves on with each claim. A domain that was released
    is therefore not claimed again at once: its last participants may not have left it yet.

    Raises:
        NoDomainLeft: Every domain is claimed.
    """
    begin = (os.getpid() + next(_places)) % len(domains)
    for domain in (*domains[begin:], *domains[:begin]):
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            claim.bind(f"\0sher3-domain-{domain}")
        except OSError:
            claim.close()
            continue
        _claims[domain] = claim
        return domain
    limit = f"{domains[0]} to {domains[-1]}"
    raise NoDomainLeft("no ROS domain is left", limit=limit, remedy="end the other processes or name a domain")


def release_domain(domain: int) -> None:
    """Release a claimed domain; for a domain that is not claimed nothing happens."""
    if claim := _claims.pop(domain, None):
        claim.close()


def _forget() -> None:
    """Forget the parent's claims in a forked process, which holds copies of the parent's sockets."""
    for domain in tuple(_claims):
        release_domain(domain)


os.register_at_fork(after_in_child=_forget)
