"""What is counted has the right plural, and a name that does not exist is answered with a similar one."""

from __future__ import annotations

from groundwork.words import counted, did_you_mean, similar


def test_a_number_has_its_noun_in_the_right_form() -> None:
    numbers = [counted(1, "day"), counted(2, "day"), counted(0, "entry"), counted(1, "entry")]

    assert numbers == ["1 day", "2 days", "0 entries", "1 entry"]


def test_the_most_similar_name_is_suggested_and_otherwise_something_else() -> None:
    assert did_you_mean("/talk", {"/tolk": 1, "/walks": 2}, "There are two.") == "Did you mean /tolk?"
    assert did_you_mean("/talk", ["/odometry"], "There is one.") == "There is one."
    assert did_you_mean("/talk", (), "") == ""
    assert did_you_mean("talkr", ["talker"], "", "`{}`") == "Did you mean `talker`?"
    assert similar("talkr", ["talker"], 0.99) == ""
