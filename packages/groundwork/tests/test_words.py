"""What is counted has the right plural, and a name that does not exist is answered with a similar one."""

from __future__ import annotations

from groundwork.words import beyond_ascii, counted, did_you_mean, look_alike, similar


def test_a_number_has_its_noun_in_the_right_form() -> None:
    numbers = [counted(1, "day"), counted(2, "day"), counted(0, "entry"), counted(1, "entry")]

    assert numbers == ["1 day", "2 days", "0 entries", "1 entry"]


def test_the_most_similar_name_is_suggested_and_otherwise_something_else() -> None:
    assert did_you_mean("/talk", {"/tolk": 1, "/walks": 2}, "There are two.") == "Did you mean /tolk?"
    assert did_you_mean("/talk", ["/odometry"], "There is one.") == "There is one."
    assert did_you_mean("/talk", (), "") == ""
    assert did_you_mean("talkr", ["talker"], "", "`{}`") == "Did you mean `talker`?"
    assert similar("talkr", ["talker"], 0.99) == ""


def test_a_character_that_can_not_be_seen_or_that_looks_like_another_is_named() -> None:
    assert "U+200B (ZERO WIDTH SPACE)" in look_alike("torso\u200b", "torso")
    assert "U+043E (CYRILLIC SMALL LETTER O)" in look_alike("t\u043erso", "torso")
    assert "U+00A0 (NO-BREAK SPACE), which no name may have." in beyond_ascii("'/a\u00a0'", "no name may have")
    assert beyond_ascii("'/a'", "no name may have") == ""
    assert [look_alike(text, "torso") for text in ("torso", "Rümpfe", "", "chest")] == [""] * 4
    assert look_alike("grüße", "") == "", "nothing is expected that it could be taken for"
