"""Judges stored recordings with changed checks. No program runs again, and nothing is replaced without confirmation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from rich.console import Console

from grader.classroom.class_display import say
from grader.classroom.request import GradedSubmission
from grader.classroom.results import ClassGrading, Tries, recordings_key
from grader.classroom.submissions import StudentSubmission, Submissions
from grader.grading.grade import Grade
from grader.grading.grading import Grading
from grader.report.feedback_plot import picture

#: A student's new grade, and how it differs from the stored one, in words.
NewGrade = tuple[StudentSubmission, GradedSubmission, str]


def rejudge(
    class_grading: ClassGrading,
    grading: Grading,
    collected: Submissions,
    submissions: Mapping[str, Tries],
    console: Console,
    may_replace: Callable[[int], bool],
) -> None:
    """Judge every student's stored recordings, print the differences, and replace grades if `may_replace` allows it.

    `may_replace` gets the number of grades that differ. If a student has no recordings, or only those of another
    submission, scenario or version, the grade stays as it is, and a message says so.
    """
    found, missing = list[NewGrade](), list[str]()
    for one in collected.handed_in:
        who = one.student.id
        kept = class_grading.results.entry(who)
        keys = {recordings_key(grading, submission): submission for submission in submissions[who]}
        stored = class_grading.results.stored(who)
        if kept is None or stored is None or stored.key not in keys:
            missing.append(who)
            continue
        grade = replace(grading.judge(keys[stored.key], stored.recordings), submission=kept[0].file)
        graded = GradedSubmission(
            who, replace(grade, seconds=kept[0].grade.seconds), picture(grade, class_grading.exercise)
        )
        found.append((one, graded, difference(kept[0].grade, grade)))
    _report(console, found, missing)
    count = sum(bool(changed) for _, _, changed in found)
    replaced = bool(count) and may_replace(count)
    for handed_in, graded, changed in found:
        if replaced or not changed:
            class_grading.keep(handed_in, graded, submissions[graded.who])
    if count and not replaced:
        console.print("Nothing was replaced.")


def _report(console: Console, found: list[NewGrade], missing: list[str]) -> None:
    for _, graded, changed in found:
        if changed:
            say(console, f"{graded.who}: {changed}")
    same = sum(not changed for _, _, changed in found)
    console.print(f"{len(found)} judged again from their recordings, {same} with the same result.")
    if missing:
        say(console, f"no recordings that fit, so grade them without --rejudge: {', '.join(missing)}", "yellow")


def difference(before: Grade, after: Grade) -> str:
    """Return the difference in words: the two scores, then the checks that went up or down. Empty if there is none."""
    old, new = ({verdict.name: verdict.earned for verdict in grade.verdicts} for grade in (before, after))
    changes = {name: new.get(name, 0.0) - old.get(name, 0.0) for name in {**new, **old}}
    up = [f"{name} ({change:+g})" for name, change in changes.items() if change > 0]
    down = [f"{name} ({change:+g})" for name, change in changes.items() if change < 0]
    text = [f"up: {', '.join(up)}"] if up else []
    text += [f"down: {', '.join(down)}"] if down else []
    if before.outcome != after.outcome:
        text.append(f"{before.outcome}, now {after.outcome}")
    if not text and before.score == after.score:
        return ""
    return "; ".join([f"{before.score:g} -> {after.score:g} points", *text])
