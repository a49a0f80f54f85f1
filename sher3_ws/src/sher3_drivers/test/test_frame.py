"""Frames: packing, unpacking, and bytes that are no frames."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_drivers.bus.condition import BusCondition, decode_error, error_frame
from sher3_drivers.bus.frame import ERROR_FLAG, EXTENDED_FLAG, Frame, iter_frames, pack_frame, pack_frames
from sher3_drivers.errors import FrameError

frames = st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8))


@given(st.lists(frames, max_size=20))
def test_frames_round_trip(given_frames):
    assert list(iter_frames(pack_frames(given_frames))) == given_frames


def test_layout_is_the_kernels():
    assert pack_frame(0x181, b"\x01\x02") == bytes.fromhex("8101000002000000 0102000000000000")


@pytest.mark.parametrize(("can_id", "data"), [(0x800, b""), (-1, b""), (1 << 32, b""), (1, bytes(9))])
def test_what_is_no_frame_is_refused(can_id, data):
    with pytest.raises(FrameError, match="limit"):
        pack_frame(can_id, data)


def test_extended_ids_need_their_flag():
    assert next(iter_frames(pack_frame(0x12345 | EXTENDED_FLAG))).can_id == 0x12345 | EXTENDED_FLAG


@given(st.binary(max_size=100))
def test_any_bytes_either_parse_or_raise(data):
    with contextlib.suppress(FrameError):
        assert len(list(iter_frames(data))) == len(data) // 16


@pytest.mark.parametrize("condition", list(BusCondition))
def test_error_frames_set_the_condition(condition):
    report = decode_error(error_frame(condition))
    assert report is not None and report.condition is condition


def test_ordinary_frame_is_no_error():
    assert decode_error(Frame(0x181, b"")) is None


@pytest.mark.parametrize(("flags", "text"), [(0x020, "acknowledge"), (0x008, "0x008")])
def test_other_error_classes_are_named(flags, text):
    report = decode_error(Frame(ERROR_FLAG | flags, bytes(8)))
    assert report is not None and report.condition is None and text in report.text
