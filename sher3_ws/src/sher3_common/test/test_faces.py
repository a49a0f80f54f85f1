"""A face imports a name when it is used, and not before."""

from __future__ import annotations

import subprocess
import sys

import pytest
from sher3_common.faces import lazy


def test_a_name_is_found_in_its_module():
    find, names = lazy("sher3_common", {"errors": ("Sher3Error", "FileError"), "reasons": ("Reason",)})
    from sher3_common.reasons import Reason

    assert find("Reason") is Reason
    assert names() == ["FileError", "Reason", "Sher3Error"]


def test_an_unknown_name_is_an_attribute_error():
    find, _ = lazy("sher3_common", {"errors": ("Sher3Error",)})
    with pytest.raises(AttributeError, match="'sher3_common' has no attribute 'Nothing'"):
        find("Nothing")


def test_the_module_is_not_imported_before_its_name_is_used():
    code = (
        "import sys; from sher3_common.faces import lazy;"
        "find, _ = lazy('sher3_common', {'samples': ('JointSample',)});"
        "assert 'sher3_common.samples' not in sys.modules; find('JointSample');"
        "assert 'sher3_common.samples' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
