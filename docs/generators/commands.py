"""Every command with its arguments, options and examples, from the command line itself."""

from __future__ import annotations

import re
from typing import Any

from generators.command_line import commands
from generators.table import table

INTRODUCTION = """# Commands

Written from the command line itself: `sher3 COMMAND --help` shows the same. A failure is one sentence on standard error
and an exit code ([operation](../operation.md)).

"""


def page() -> str:
    """Return the page."""
    return INTRODUCTION + "\n".join(_section(name, command) for name, command in commands())


def _section(name: str, command: Any) -> str:
    text = f"## {name}\n\n{_paragraphs(command.help or '')}\n\n"
    context = command.context_class(command, info_name=name)
    rows = [row for parameter in command.get_params(context) if (row := _parameter(parameter))]
    text += table(("argument or option", "meaning", "default"), rows) + "\n" if rows else ""
    return text + (f"{_paragraphs(command.epilog)}\n" if command.epilog else "")


def _parameter(parameter: Any) -> tuple[str, str, str] | None:
    if getattr(parameter, "hidden", False) or "--help" in parameter.opts:
        return None
    if parameter.param_type_name == "argument":
        name = f"`{(parameter.metavar or parameter.name or '').upper()}`"
        return name + ("" if parameter.required else ", may be left out"), getattr(parameter, "help", None) or "", ""
    names = ", ".join(f"`{name}`" for name in [*parameter.opts, *parameter.secondary_opts])
    return names, parameter.help or "", _default(parameter)


def _default(parameter: Any) -> str:
    if parameter.is_flag or parameter.default in (None, "", (), []) or callable(parameter.default):
        return ""
    return f"`{getattr(parameter.default, 'value', parameter.default)}`"


def _paragraphs(text: str) -> str:
    """Return help text without the marks of Click's own wrapping, and with words such as `*.yaml` left as they are."""
    text = re.sub(r"\[/?(bold|red|green|cyan|dim|italic)\]", "", text.replace("\b", ""))
    return "\n".join(line.strip() for line in text.strip().splitlines())
