"""Every command that the pages show is run, or at least exists with its options."""

from __future__ import annotations

import re

import pytest
from documentation.commands import Command, commands, words
from documentation.expected import tolerance, unlike
from documentation.pages import Block, Unit, blocks, pages, shown_output, spans, units
from documentation.terminal import Terminal

NOT_RUN = 28
"""Blocks that cannot be run here, at most. Each says why, where the reader sees it."""


def marks(slow: bool, lines: list[Command]) -> list[pytest.MarkDecorator]:
    """Commands that nothing can hold up run beside all other tests."""
    held_up = any(command.in_wall_time for command in lines)
    found = [pytest.mark.slow, pytest.mark.timeout(1800)] if slow else []
    return [*found, pytest.mark.graph, pytest.mark.flaky(reruns=2)] if held_up else found


def cases() -> list[object]:
    shown = [(unit, [c for b in unit.blocks if not b.file for c in commands(b)]) for unit in units("sh")]
    return [pytest.param(unit, marks=marks(unit.slow, lines), id=unit.name) for unit, lines in shown]


@pytest.mark.parametrize("unit", cases())
def test_commands_of_a_page(unit: Unit, terminal, inputs):
    """Each ends with exit code 0, or with the one that stands beside it."""
    inputs.put(terminal.folder, "\n".join(_shown(block) for block in unit.blocks))
    follow(unit, terminal)


def follow(unit: Unit, terminal: Terminal) -> None:
    """Write the files of a unit and run its commands; what they print is what the page says."""
    for block in unit.blocks:
        follow_block(block, terminal)
    terminal.interrupt()


def follow_block(block: Block, terminal: Terminal) -> None:
    """Write the file of a block, or run its commands and compare what they print with the fence that follows it."""
    if block.file:
        (terminal.folder / block.file).parent.mkdir(parents=True, exist_ok=True)
        (terminal.folder / block.file).write_text(block.text)
    elif block.language == "sh":
        printed = "".join(terminal.run(command) for command in commands(block))
        output = dict(shown_output(block.page)).get(block)
        if output is not None:
            fault = unlike(output.text, printed, tolerance(output))
            assert not fault, f"{output.page}:{output.line}: {fault}\n{printed[-6000:]}"


def _shown(block) -> str:
    return f"file: {block.file}" if block.file else block.text


BLANK = re.compile(r"\b[A-Z]{2,}(?![\w.])")
"""What the reader fills in: `--dask ADDRESS`; `DATA.mat` is a file."""


def tables() -> list[str]:
    """Return every command in a table, once: a name with nothing behind it is only a name, and a blank is not run."""
    found = {line for page in pages() for _, in_table, line in spans(page) if in_table}
    return sorted(x for x in found if len(re.sub("^sher3( gap)?", "", x).split()) > 1 and not BLANK.search(x))


SLOW_IN_TABLES = ("sher3 benchtop", "sher3 design", "sher3 paper", "sher3 gap", "sher3 safety --", "sher3 demo")


def in_tables() -> list[object]:
    """Return the commands in tables as cases: each by itself, but those that need a robot beside the same one."""
    lines = [(line, line.startswith(SLOW_IN_TABLES)) for line in tables()]
    # The script of a surgeon comes first, and the fault last: what it breaks is in no other command's way.
    beside = sorted((line for line, slow in lines if not slow and Command(line).needs_robot), reverse=True)
    alone = [([line], slow) for line, slow in lines if line not in beside]
    cases = [*alone, (beside, False)]
    return [pytest.param(x, marks=marks(slow, [Command(line) for line in x]), id=", ".join(x)) for x, slow in cases]


@pytest.mark.parametrize("lines", in_tables())
def test_commands_in_tables(lines, terminal, inputs):
    inputs.put(terminal.folder, "\n".join(lines))
    for line in lines:
        terminal.run(Command(line))
    terminal.interrupt()


def test_commands_in_the_text_exist_with_their_options(command_tree):
    """In running text a command may be cut short: its name and its options must be those of the command line."""
    groups = {" ".join(name.split()[:n]) for name in command_tree for n in (1, 2)}
    shown = [(page, number, line) for page in pages() for number, _, line in spans(page)]
    assert len(shown) > 50
    for page, number, line in shown:
        here = f"{page}:{number}: {line}"
        said = words(line.replace("[", "").replace("]", "").replace("...", ""))
        name = next((" ".join(said[:n]) for n in (3, 2) if " ".join(said[:n]) in command_tree), None)
        if name is None:
            assert " ".join(said[:2]) in groups or said[1].isupper(), here
            continue
        known = {option for p in command_tree[name].params for option in [*p.opts, *p.secondary_opts]} | {"--help"}
        used = {word.split("=")[0] for word in said if re.fullmatch(r"--?[a-z][\w-]*(=.*)?", word)}
        assert used <= known, f"{here} has {sorted(used - known)}"


def test_what_talks_to_a_graph_runs_alone(command_tree):
    """A command with an option `--domain` talks to a graph, whatever its name."""
    talks = {name for name, command in command_tree.items() if any("--domain" in p.opts for p in command.params)}
    assert talks and all(Command(name).in_wall_time for name in talks)


def test_what_is_not_run_says_why():
    """A block that cannot be run here gives its reason on the page itself, and such blocks are few."""
    reasons = {f"{page}:{b.line}": b.not_run for page in pages() for b in blocks(page) if b.not_run is not None}
    assert all(len(reason) > 10 for reason in reasons.values()), reasons
    assert len(reasons) <= NOT_RUN, reasons


def test_every_shell_block_holds_commands():
    """The tests above must be able to fail: what they read from the pages is there."""
    assert sum(len(commands(block)) for unit in units("sh") for block in unit.blocks if not block.file) > 50
    assert len(tables()) >= 8
