"""Every command with its arguments, options and examples, a page each, from the command line itself."""

from __future__ import annotations

import re
from typing import Any

from generators.command_line import commands
from generators.table import table

INTRODUCTION = """# Commands

Written from the command line itself: `sher3 COMMAND --help` shows the same. A failure is one sentence on standard error
and an exit code ([operation](../operation.md)).

"""


def pages() -> tuple[str, dict[str, str]]:
    """Return the list of all commands, and a page for each by its file's name."""
    found = dict(commands())
    parts = {_file(name): _page(name, command) for name, command in found.items()}
    rows = [(f"[`{name}`](commands/{_file(name)}.md)", _first(command.help or "")) for name, command in found.items()]
    return INTRODUCTION + table(("command", "what it does"), rows), parts


def _file(name: str) -> str:
    """Return the path of a command's page: those of a group stand in a folder of its name."""
    return "/".join(name.split()[1:])


def _first(text: str) -> str:
    """Return the first sentence of a help text."""
    return _paragraphs(text).partition("\n")[0]


def _page(name: str, command: Any) -> str:
    text = f"# {name}\n\n{_paragraphs(command.help or '')}\n\n"
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
