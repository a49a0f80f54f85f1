"""The pages of the project and what is shown on them: fenced blocks, and commands between backticks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from sources import ROOT

MADE = ("docs/reference/generated/", "docs/reference/api/")
"""Folders of pages that are written from the sources; what they show is tested where it comes from."""
ARCHIVE = "docs/archive/"
"""Folder of earlier figures: commands in it are those of their day."""
LESSONS = ("docs/tutorial/", "docs/how-to/")
"""Folders whose pages are followed from top to bottom: the commands of a page run one after the other."""
FENCE = re.compile(r"^(?P<marks>```+)(?P<info>[^`\n]*)\n(?P<text>.*?)^(?P=marks)\s*$", re.M | re.S)
SPAN = re.compile(r"(?<!`)`(sher3 [^`\n]+)`(?!`)")


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes:
        page: path from the root of the project.
        line: of its first line of content.
        language: first word after the fence, empty if there is none.
        tag: the other words: `slow`, `not-run: reason`, `file: name`.
        text: content, one newline at the end of each line.
    """

    page: str
    line: int
    language: str
    tag: str
    text: str

    @property
    def not_run(self) -> str | None:
        """Why it is not run, or None."""
        return self.tag.removeprefix("not-run:").strip() if self.tag.startswith("not-run") else None

    @property
    def file(self) -> str | None:
        """Name of the file that the reader is told to write, or None."""
        return self.tag.removeprefix("file:").strip() if self.tag.startswith("file:") else None


def pages() -> list[str]:
    """Return the paths of all pages that people write."""
    found = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "docker" / "README.md", *ROOT.glob("docs/**/*.md")]
    paths = sorted(str(path.relative_to(ROOT)) for path in found if path.exists())
    return [path for path in paths if not path.startswith((*MADE, ARCHIVE))]


def blocks(page: str) -> list[Block]:
    """Return the fenced blocks of a page in their order."""
    text = (ROOT / page).read_text()
    found = []
    for match in FENCE.finditer(text):
        language, _, tag = match["info"].strip().partition(" ")
        line = text.count("\n", 0, match.start("text")) + 1
        found.append(Block(page, line, language, tag.strip(), match["text"]))
    return found


def shown_output(page: str) -> Iterator[tuple[Block, Block]]:
    """Yield every block that is run with the fence of its output: one `text` that is the next fence of the page."""
    here = blocks(page)
    for block, following in pairwise(here):
        ran = block.language in ("sh", "python") and block.not_run is None and not block.file
        if ran and following.language == "text":
            yield block, following


def spans(page: str) -> Iterator[tuple[int, bool, str]]:
    """Yield every `sher3 ...` between backticks outside fences: line, whether it stands in a table, command."""
    text = (ROOT / page).read_text()
    outside = FENCE.sub(lambda match: re.sub(r"[^\n]", "", match.group()), text)
    for number, line in enumerate(outside.splitlines(), start=1):
        for match in SPAN.finditer(line):
            yield number, line.lstrip().startswith("|"), match[1].replace("\\|", "|")


@dataclass(frozen=True)
class Unit:
    """Blocks that run one after the other in one folder.

    Attributes:
        name: page and line, for the test's name.
        blocks: in their order.
    """

    name: str
    blocks: tuple[Block, ...]

    @property
    def slow(self) -> bool:
        """Whether some block is marked so."""
        return any(block.tag == "slow" for block in self.blocks)


def units(language: str) -> list[Unit]:
    """Return what is run of one language: a lesson as a whole, with the files it writes; else each block by itself."""
    found = []
    for page in pages():
        here = [b for b in blocks(page) if b.not_run is None and (b.language == language or b.file)]
        if not any(b.language == language and not b.file for b in here):
            continue
        if page.startswith(LESSONS):
            found.append(Unit(page, tuple(here)))
        else:
            found += [Unit(f"{page}:{b.line}", (b,)) for b in here]
    return found
