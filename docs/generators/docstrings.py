"""Docstrings as reStructuredText: they are plain text, with `code` in single backticks as in Markdown.

Whatever would be markup by accident (a star, a bar, an underscore at the end of a word) is escaped, so that the way a
docstring is rendered cannot break the site. The sections (`Args:`, `Raises:`, ...) are left to napoleon.
"""

from __future__ import annotations

import re

CODE = re.compile(r"(``[^`]*``|`[^`]*`)")
BULLET = re.compile(r"\s*([-*+]|\d+[.)])\s")
SECTION = re.compile(r"\s*(Args|Attributes|Class attributes|Returns|Raises|Yields|Example|Examples|Note):\s*$")


def to_restructured_text(app, what, name, thing, options, lines: list[str]) -> None:
    """Rewrite the `lines` of a docstring in place (a listener of `autodoc-process-docstring`)."""
    lines[:] = convert(lines)


def convert(lines: list[str]) -> list[str]:
    """Return plain text as reStructuredText.

    An indented paragraph after a blank line is an equation or a layout and stays as it is written; a list is set off
    from the text around it by blank lines.
    """
    out: list[str] = []
    literal = in_section = in_list = False
    for line in lines:
        blank, indented = not line.strip(), line.startswith(("    ", "\t"))
        if SECTION.match(line):
            in_section, literal, in_list = True, False, False
        elif line.strip() and not indented and in_section and not line.startswith(" "):
            in_section = False
        if indented and not in_section and not literal and not in_list and (not out or not out[-1].strip()):
            out += ["::", ""]
            literal = True
        if line.startswith(" ") and not (in_section or literal or in_list or blank) and out and out[-1].strip():
            line = line.strip()
        if literal and (indented or blank):
            out.append(line)
            continue
        literal = False
        if not in_section and not blank:
            bullet = bool(BULLET.match(line))
            if bullet != in_list and not line.startswith(" ") and out and out[-1].strip():
                out.append("")
            in_list = bullet or (in_list and line.startswith(" "))
        out.append(_escape(line))
    return out


def _escape(line: str) -> str:
    parts = CODE.split(line)
    lead = re.match(r"\s*[-*+]\s", parts[0])
    keep = lead.group() if lead else ""
    parts[0] = parts[0][len(keep) :]
    for i, part in enumerate(parts):
        if i % 2:
            parts[i] = "``" + part.strip("`").replace("\\", "\\\\") + "``" if part.strip("` ") else "\\`\\`"
        else:
            parts[i] = re.sub(r"([\\*|`])", r"\\\1", part)
            parts[i] = re.sub(r"(?<=\w)_(?!\w)", r"\\_", parts[i])
    # A literal needs room around it: "`a`s" becomes "``a``\ s".
    for i in range(1, len(parts), 2):
        if parts[i + 1][:1].isalnum():
            parts[i + 1] = "\\ " + parts[i + 1]
        if parts[i - 1][-1:].isalnum() or parts[i - 1][-1:] in "_/":
            parts[i - 1] += "\\ "
    return keep + "".join(parts)
