"""Domains: one for the graphs of a process, never that of another process."""

import subprocess
import sys

import pytest
from sher3_runtime.domains import IN_PROCESS, NoDomainLeft, claim_domain, own_domain, release_domain

ALONE = range(210, 213)


@pytest.fixture
def claimed():
    found = [claim_domain(ALONE) for _ in ALONE]
    yield found
    for domain in found:
        release_domain(domain)


def test_a_process_has_one_domain_for_its_graphs():
    assert own_domain() == own_domain() and own_domain() in IN_PROCESS


def test_no_domain_is_claimed_twice_and_the_lack_of_one_is_said(claimed):
    assert sorted(claimed) == list(ALONE)
    with pytest.raises(NoDomainLeft, match="limit 210 to 212; end the other"):
        claim_domain(ALONE)
    release_domain(claimed[1])
    assert claim_domain(ALONE) == claimed[1]


def say(script, *arguments):
    """Run a script in a process of its own that ends without clearing up; return the numbers it prints."""
    script = "import os, sys; from sher3_runtime.domains import own_domain; me = os.getpid()\n" + script
    command = [sys.executable, "-c", script + "\nsys.stdout.flush(); os.kill(me, 9)", *map(str, arguments)]
    return [int(word) for word in subprocess.run(command, capture_output=True, timeout=60).stdout.split()]


def test_another_process_gets_another_domain_and_a_dead_one_holds_none():
    """Their process numbers alone would give both the same one."""
    mine = own_domain()
    script = "os.getpid = lambda: int(sys.argv[1]) - IN_PROCESS[0]\nprint(own_domain())"
    script = "from sher3_runtime.domains import IN_PROCESS\n" + script
    first, second = (say(script, mine) for _ in range(2))
    assert first == second and mine not in first and len(first) == 1


def test_a_forked_process_claims_its_own():
    script = """
print(own_domain(), flush=True)
if os.fork() == 0:
    print(own_domain(), flush=True)
    os._exit(0)
os.wait()
print(own_domain())
"""
    before, child, after = say(script)
    assert before == after != child
