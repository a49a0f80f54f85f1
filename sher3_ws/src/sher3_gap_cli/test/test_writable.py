"""What cannot be written is refused before the work that would be lost with it."""

import pytest
from invoking import invoke
from sher3_gap_cli.app import app
from sher3_gap_cli.options import RequestError, check_writable


def test_where_nothing_could_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for files, folders, said in (
        ([tmp_path], [], "is a folder"),
        ([tmp_path / "no" / "x"], [], "there is no folder"),
        ([tmp_path / "file" / "x"], [], "is no folder"),
        ([], [tmp_path / "file"], "is no folder"),
        ([], [tmp_path / "file" / "x"], "is no folder"),
    ):
        with pytest.raises(RequestError, match=said):
            check_writable(files, folders)
    check_writable([tmp_path / "new", tmp_path / "file", None], [tmp_path, tmp_path / "a" / "b", None])


@pytest.mark.parametrize(
    "words",
    [
        ["diagnose", "nowhere", "--out", "file"],
        ["discover", "nowhere", "--out", "file"],
        ["describe", "nowhere.csv", "--out", "no/x.yaml"],
        ["import", "nowhere.csv", "emps", "--out", "file"],
        ["export", "nowhere.json", "--out", "no/x.yaml"],
        ["experiment", "nowhere.json", "--output", "no/x.yaml"],
    ],
)
def test_commands_look_there_first(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    found = invoke(app, words)
    assert found.exit_code == 2 and "cannot be written" in found.output, found.output
