"""What the set-up compiles the laws with is a diagnosis that goes all the way: a fault is found and named."""

from sher3_gap_cli.warm import warm_up


def test_the_case_of_the_set_up_names_its_cause():
    assert warm_up() == "attributed"
