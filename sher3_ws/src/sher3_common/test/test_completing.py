from sher3_common.commands.completing import BAG, CASE, folders_with, words


def test_bags_and_cases_are_offered_and_other_folders_to_go_into(tmp_path):
    (tmp_path / "trial").mkdir()
    (tmp_path / "trial" / "trial_0.mcap").touch()
    (tmp_path / "tests").mkdir()
    (tmp_path / "case").mkdir()
    (tmp_path / "case" / "case.yaml").touch()
    (tmp_path / "notes.txt").touch()
    (tmp_path / "loose.mcap").touch()
    assert folders_with(BAG)(f"{tmp_path}/t") == [f"{tmp_path}/tests/", f"{tmp_path}/trial"]
    assert folders_with(BAG)(f"{tmp_path}/") == [
        f"{tmp_path}/case/", f"{tmp_path}/loose.mcap", f"{tmp_path}/tests/", f"{tmp_path}/trial",
    ]  # fmt: skip
    assert f"{tmp_path}/case" in folders_with(CASE)(f"{tmp_path}/")


def test_a_folder_that_is_not_there_offers_nothing(tmp_path):
    assert folders_with(CASE)(f"{tmp_path}/no/such") == []


def test_words():
    assert words(lambda: ["roll", "delta_2", "delta_1"])("de") == ["delta_1", "delta_2"]
