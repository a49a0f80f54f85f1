"""A forked Python is as good as a new one: nothing of the project is loaded, and no script sees another's traces."""

import subprocess

LOOK = """
import os, sys
print([m for m in sys.modules if m.startswith("sher3")], os.getcwd(), os.environ["MARK"], sys.argv, sys.path[0])
print(input(), file=sys.stderr)
os.environ["MARK"] = "left by another"
os.chdir("/")
import sher3_common
sys.exit(len(sys.argv))
"""


def test_a_script_has_folder_environment_files_and_exit_code_of_its_own(tmp_path, forked_python):
    (tmp_path / "look.py").write_text(LOOK)
    for words in ([], ["a", "b c"]):
        command = [forked_python.folder / "python", "look.py", *words]
        done = subprocess.run(
            command, cwd=tmp_path, env={"MARK": "mine"}, input="said\n", capture_output=True, text=True
        )
        assert done.stdout == f"[] {tmp_path} mine {['look.py', *words]} {tmp_path}\n"
        assert (done.stderr, done.returncode) == ("said\n", 1 + len(words))


def test_a_command_that_fails_or_is_killed_says_so(tmp_path, forked_python):
    done = subprocess.run(
        [forked_python.folder / "sher3", "gap", "diagnose", "nothing"], cwd=tmp_path, capture_output=True
    )
    assert done.returncode == 2 and b"nothing" in done.stderr
    (tmp_path / "killed.py").write_text("import os; os.kill(os.getpid(), 9)")
    assert subprocess.run([forked_python.folder / "python", "killed.py"], cwd=tmp_path).returncode == 137
