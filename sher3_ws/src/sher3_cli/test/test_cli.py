"""The command line: help, examples, completion, and one sentence per failure. No graph is started."""

import subprocess
import sys

import pytest
import typer
from sher3_cli.root import COMMANDS, main, make_app
from sher3_runtime.environment import child_environment
from typer.testing import CliRunner


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command):
    result = CliRunner().invoke(make_app(command), [command, "--help"])
    assert result.exit_code == 0, result.output
    if COMMANDS[command].command:
        assert "Example" in result.output


def commands_below(command, path=()):
    """Yield (name, command) of everything that can be run; a group that runs by itself counts too."""
    for name, child in getattr(command, "commands", {}).items():
        yield from commands_below(child, (*path, name))
    if not hasattr(command, "commands") or (path and command.invoke_without_command):
        yield " ".join(path), command


def test_every_command_that_prints_figures_also_prints_json():
    rows = list(commands_below(typer.main.get_command(make_app("*"))))
    assert {"gap monitor", "safety", "safety budget"} <= {name for name, _ in rows}
    without = {name for name, command in rows if not any("--json" in option.opts for option in command.params)}
    assert without == {"teleop", "completion"}


def test_help_names_every_command_and_imports_none():
    """The list of commands must not wait for numba, rclpy or matplotlib."""
    code = (
        "import sys\nfrom sher3_cli.root import main\n"
        "try:\n    main(['--help'])\nexcept SystemExit:\n    pass\n"
        "heavy = {'numba', 'rclpy', 'matplotlib', 'scipy', 'pinocchio'} & set(sys.modules)\n"
        "sys.exit(f'imported {heavy}' if heavy else 0)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], env=child_environment(), capture_output=True, text=True, timeout=60
    )
    assert result.returncode == 0, result.stderr
    assert all(name in result.stdout for name in COMMANDS)


@pytest.mark.parametrize(
    ("arguments", "status", "sentence"),
    [
        (["up", "--rate", "5000"], 2, "rate: Input should be less than or equal to 1000"),
        (["up", "--nodes", "pedal+pedals"], 2, "unknown node pedals"),
        (["up", "--real"], 2, "needs --can"),
        (["up", "--robot", "/nowhere.yaml"], 2, "/nowhere.yaml: no such file"),
        (["teleop", "/nowhere.yaml"], 2, "/nowhere.yaml: no such file"),
        (["demo", "--folder", "/proc/none/bags"], 2, "cannot be written"),
        (["no-such-command"], 2, "no such command"),
    ],
)
def test_a_failure_is_a_sentence_and_an_exit_code(arguments, status, sentence, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    printed = capsys.readouterr()
    assert caught.value.code == status
    assert sentence in printed.err.replace("\n", " ")
    assert "Traceback" not in printed.err


def test_teleop_prints_a_script_to_start_from(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["teleop", "--print"])
    assert caught.value.code == 0
    assert "sher3.teleop/1" in capsys.readouterr().out


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_scripts(shell, capsys):
    with pytest.raises(SystemExit):
        main(["completion", shell])
    assert "_SHER3_COMPLETE" in capsys.readouterr().out


def test_version_and_short_help(capsys):
    for words, expected in ((["--version"], "sher3 "), (["-h"], "Usage: sher3"), (["gap", "-h"], "Usage: sher3 gap")):
        with pytest.raises(SystemExit) as end:
            main(words)
        assert end.value.code == 0
        assert expected in capsys.readouterr().out


@pytest.mark.parametrize(("typed", "meant"), [("uo", "up"), ("demoo", "demo"), ("analyse", "analyze")])
def test_a_slip_is_answered_with_what_was_meant(typed, meant, capsys):
    with pytest.raises(SystemExit) as end:
        main([typed])
    assert end.value.code == 2
    assert f"did you mean {meant}?" in capsys.readouterr().err


def test_a_place_where_nothing_can_be_written_is_a_sentence(tmp_path):
    in_the_way = tmp_path / "file"
    in_the_way.touch()
    words = ["record", str(in_the_way / "bag"), "--seconds", "0.1"]
    done = subprocess.run([sys.executable, "-m", "sher3_cli", *words], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert "folder cannot be made" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("library", "extra"), [("rclpy.node", "robot"), ("std_msgs", "robot"), ("distributed", "cluster"), ("mcap", "bags")]
)
def test_a_missing_library_names_its_extra(monkeypatch, capsys, library, extra):
    def fail(*_):
        raise ModuleNotFoundError(name=library)

    monkeypatch.setattr("sher3_cli.root.make_app", fail)
    with pytest.raises(SystemExit) as ended:
        main(["gap"])
    assert ended.value.code == 2
    assert f"sher3[{extra}]" in capsys.readouterr().err
