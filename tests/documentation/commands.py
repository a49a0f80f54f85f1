"""Commands as a page shows them, one a line, and how they are run."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass

from documentation.pages import Block

FOREVER = ("sher3 up", "sher3 gap monitor", "sher3 gap watch", "sher3 record")
"""Commands that end at Ctrl-C, unless one of the options of `ENDS` is given."""
ENDS = re.compile(r"--(duration|seconds)\b")
NEEDS_ROBOT = ("sher3 teleop", "sher3 fault", "sher3 record", "sher3 gap monitor", "sher3 gap excite")
"""Commands that talk to a running robot, unless one of the options of `ALONE` is given."""
GRAPH = ("sher3 up", "sher3 demo", "sher3 view", "sher3 state", "sher3 foxglove", "sher3 replay", "sher3 gap watch")
"""Commands that begin a graph or talk to one, beside those of `NEEDS_ROBOT`."""
ALONE = re.compile(r"--(simulate|print|help|urdf|html)\b")

VARIABLES = re.compile(r"^(?:[A-Z]\w*=\S+\s+)+")
"""Variables set in front of a command."""


@dataclass(frozen=True)
class Command:
    """One line of a shell.

    Attributes:
        line: without its comment.
        exit_code: the one its comment names, as in `# exit code 2`; else 0.
        interrupts: a line that is nothing but the comment `# Ctrl-C`: what still runs is interrupted.
    """

    line: str
    exit_code: int = 0
    interrupts: bool = False

    @property
    def bare(self) -> str:
        """The line without variables that are set for it alone."""
        return VARIABLES.sub("", self.line)

    @property
    def forever(self) -> bool:
        """Whether it runs until Ctrl-C."""
        return self.bare.startswith(FOREVER) and not ENDS.search(self.line)

    @property
    def in_wall_time(self) -> bool:
        """Whether work beside it may hold it up: it talks to a graph, or it measures."""
        talks = self.bare.startswith((*GRAPH, *NEEDS_ROBOT)) and not ALONE.search(self.line)
        return talks or "bench/" in self.line

    @property
    def own_process(self) -> bool:
        """Whether it loads the large libraries itself: a robot is many processes, and a bench measures its own."""
        return self.bare.startswith(("sher3 up", "sher3 demo")) or "bench/" in self.line

    @property
    def needs_robot(self) -> bool:
        """Whether a robot must be up."""
        return (
            self.bare.startswith(NEEDS_ROBOT)
            and not ALONE.search(self.line)
            and self.line.strip() != "sher3 gap excite"
        )


def commands(block: Block) -> list[Command]:
    """Return the commands of a block; a backslash at the end of a line joins the next one to it."""
    found = []
    for line in block.text.replace("\\\n", " ").splitlines():
        code, _, comment = line.partition("#") if line.startswith("#") else re.split(r"(\s#|$)", line, maxsplit=1)
        if "Ctrl-C" in comment and not code.strip():
            found.append(Command("", interrupts=True))
        if code.strip():
            expected = re.search(r"exit code (\d+)", comment)
            found.append(Command(code.strip(), int(expected[1]) if expected else 0))
    return found


def shortened(line: str) -> str:
    """Return the command with a range of seeds cut to its first seed: each seed is a case of its own."""
    return re.sub(r"--seeds (\d+):\d+", lambda match: f"--seeds {match[1]}:{int(match[1]) + 1}", line)


def in_company(line: str, domain: int, takes_domain: set[str]) -> str:
    """Return the command as it runs beside others: on a ROS domain of the test's own, a robot without priority.

    With real-time priority a robot on a busy machine of two cores takes both from the commands beside it.
    """
    variables = match.group() if (match := VARIABLES.match(line)) else ""
    line = line[len(variables) :]
    if line.startswith("sher3 up") and "--realtime" not in line:
        line = line.replace("sher3 up", "sher3 up --realtime 0", 1)
    for name in sorted(takes_domain, key=len, reverse=True):
        if re.match(rf"{name}(\s|$)", line):
            return f"{variables}{name} --domain {domain}{line[len(name) :]}"
    return variables + line


def words(line: str) -> list[str]:
    """Return the words of a command, up to a redirection or a pipe."""
    return shlex.split(re.split(r"\s(?:>|>>|\|)\s", line)[0])
