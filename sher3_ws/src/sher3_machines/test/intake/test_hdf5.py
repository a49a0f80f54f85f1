"""HDF5 files are refused by what they are, with a conversion that can be run."""

import pytest
from sher3_machines import MachineError
from sher3_machines.intake.readers.hdf5 import CONVERTS, MAGIC
from sher3_machines.intake.tables import read_tables


@pytest.mark.parametrize("name", ["a.h5", "a.hdf5", "a.H5"])
@pytest.mark.parametrize("in_folder", [False, True])
def test_the_refusal_names_the_kind_and_the_conversion(tmp_path, name, in_folder):
    (tmp_path / name).write_bytes(MAGIC + bytes(100))
    with pytest.raises(MachineError, match=r"HDF5 is not read.*import h5py.*a\.npz"):
        read_tables(tmp_path if in_folder else tmp_path / name)


@pytest.mark.parametrize("raw", [b"MATLAB 7.3 MAT-file, Platform: GLNXA64" + bytes(474) + MAGIC, MAGIC + bytes(100)])
def test_a_new_matlab_file_is_one_too(tmp_path, raw):
    (tmp_path / "a.mat").write_bytes(raw)
    with pytest.raises(MachineError, match=r"version 7\.3, which is HDF5.*-v7, or convert it.*import h5py"):
        read_tables(tmp_path / "a.mat")


def test_the_conversion_is_python():
    compile(CONVERTS, "one line", "exec")
    assert '"' not in CONVERTS  # it stands in quotes of a shell
