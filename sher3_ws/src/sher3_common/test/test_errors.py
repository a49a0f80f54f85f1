"""What every error carries."""

from sher3_common import Sher3Error


def test_an_unknown_name_is_told_with_the_nearest_of_those_known():
    near = Sher3Error.unknown("no such effect", "backlsh", ["backlash", "cogging"])
    assert str(near) == "no such effect; value backlsh; limit backlash, cogging; did you mean backlash?"
    assert Sher3Error.unknown("no such effect", "x", {"backlash": 1}).remedy == "name one of them"
