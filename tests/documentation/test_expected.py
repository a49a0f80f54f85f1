"""The comparison of what a page shows with what is printed: it must be able to fail."""

import pytest
from documentation.expected import same, unlike
from documentation.pages import blocks, pages, shown_output

VERDICT = "verdict  attributed: Backlash on tilt, 59.2 µm: 100 % of the gap."


@pytest.mark.parametrize(
    ("printed", "alike"),
    [
        (VERDICT, True),
        (VERDICT.replace("59.2", "59.6"), True),
        (VERDICT.replace("59.2", "62.0"), False),
        (VERDICT.replace("Backlash", "Coulomb friction"), False),
        (VERDICT.replace("attributed", "outside_library"), False),
        (VERDICT.replace("µm", "mm"), False),
        (VERDICT + " And more.", False),
    ],
)
def test_words_are_exact_and_numbers_within_the_tolerance(printed, alike):
    assert same(VERDICT, printed, 0.01) is alike


def test_counts_and_digits_in_names_are_no_measurements():
    assert not same("found in 3 of 3 parts", "found in 2 of 3 parts", 0.01)
    assert not same("ready: 7 processes", "ready: 8 processes", 0.01)
    assert not same("case_001 delta_1", "case_001 delta_2", 0.9)


def test_dots_stand_for_text_and_for_lines():
    assert same("ready: 7 processes ... in 1.98 s; ...", "ready: 7 processes at 500 Hz in 1.97 s; Ctrl-C", 0.01)
    printed = "compiling\nverdict  a\nwhere  b\ncause  c\n"
    assert unlike("verdict  a\ncause  c", printed) != ""
    assert unlike("verdict  a\n...\ncause  c", printed) == ""
    assert unlike("cause  c\n...\nverdict  a", printed) != ""


def test_the_fence_states_a_wider_tolerance():
    assert unlike("gain 1.00", "gain 1.04", 0.05) == "" and unlike("gain 1.00", "gain 1.04") != ""


ANSWERS = ("sher3 gap diagnose", "sher3 gap discover", "sher3 safety budget", "sher3 fk")
"""Commands that are typed for what they print."""
FOLLOWED = ("README.md", "docs/tutorial/", "docs/how-to/")
"""Pages on which the reader compares."""


@pytest.mark.parametrize("page", [page for page in pages() if page.startswith(FOLLOWED)])
def test_a_command_that_is_typed_for_its_answer_is_shown_with_it(page):
    # What is read from DATA.* is the reader's own, and so is the answer.
    shells = [b for b in blocks(page) if b.language == "sh" and b.not_run is None and "DATA." not in b.text]
    answered = "".join(block.text for block, _ in shown_output(page))
    typed = {name for block in shells for name in ANSWERS if name in block.text}
    assert not {name for name in typed if name not in answered}, f"{page}: show what it prints in a fence `text`"


def test_output_is_shown():
    assert sum(len(list(shown_output(page))) for page in pages()) >= 15
