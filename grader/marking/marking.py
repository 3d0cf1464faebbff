"""The run of a class: what has to be graded, what has not, and what is kept when."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from grader.classroom import Adjustment, Entry
from grader.exercise import Exercise
from grader.feedback.page import feedback_page
from grader.grading.grading import Grading
from grader.intake import HandedIn, Intake
from grader.marking.key import recordings_key, with_submission
from grader.marking.marks import Marked, Markers
from grader.marking.results import Results
from grader.submission import Submission

#: What late work and the instructor's own wishes make of a score.
Adjust = Callable[[Entry], tuple[Adjustment, ...]]


@dataclass(frozen=True)
class Plan:
    """What a run is going to do. `former` are the entries of an earlier run, by student."""

    to_grade: tuple[HandedIn, ...]
    unchanged: tuple[Entry, ...]
    former: Mapping[str, Entry]


@dataclass
class Marking:
    """One class, graded into one folder of results by `markers`."""

    exercise: Exercise
    markers: Markers
    results: Results
    adjust: Adjust
    grading: Grading | None = None
    """Set where recordings are to be kept."""
    entries: dict[str, Entry] = field(default_factory=dict)

    def plan(self, intake: Intake, submissions: Mapping[str, Submission], regrade: Callable[[str], bool]) -> Plan:
        """What has to be graded: what has no grade yet, what has changed, and what `regrade` asks for.

        `submissions` are those of `intake`, read, by student.
        """
        to_grade, unchanged, former = [], [], {}
        for handed_in in intake.handed_in:
            who = handed_in.student.id
            kept = self.results.entry(who)
            if kept:
                former[who] = kept[0]
            if kept and kept[1] == self._key(submissions[who]) and not regrade(who):
                unchanged.append(self._still(handed_in, kept[0], kept[1]))
            else:
                to_grade.append(handed_in)
        return Plan(tuple(to_grade), tuple(unchanged), former)

    def take_in(self, intake: Intake) -> None:
        """Take the entries that are kept of these students, where no other is known, as they are."""
        for one in intake.handed_in:
            kept = self.results.entry(one.student.id)
            if kept and one.student.id not in self.entries:
                self.entries[one.student.id] = kept[0]

    def run(self, plan: Plan, submissions: Mapping[str, Submission]) -> Iterator[Entry]:
        """Grade what has to be, and give each entry once it is kept.

        Where a machine or we were at fault, it is tried once more after all others; if that is in vain, the
        entry tells of it, has no score, and is graded again by the next run.
        """
        handed_in = {one.student.id: one for one in plan.to_grade}
        again: list[str] = []
        for marked in self.markers.mark({who: submissions[who] for who in handed_in}):
            if marked.grade.outcome == "host-error":
                again.append(marked.who)
            else:
                yield self._kept(handed_in[marked.who], marked, submissions[marked.who])
        for marked in self.markers.mark({who: submissions[who] for who in sorted(again)}):
            yield self._kept(handed_in[marked.who], marked, submissions[marked.who])

    def _kept(self, handed_in: HandedIn, marked: Marked, submission: Submission) -> Entry:
        """Keep a grade; one whose page or files can't be written is a `host-error`, and stops nobody else's."""
        try:
            return self.keep(handed_in, marked, submission)
        except Exception as error:
            return self.give_up(Entry(handed_in.student, handed_in.file.name, marked.grade), not_written(error))

    def give_up(self, entry: Entry, what: str) -> Entry:
        """Turn an entry into a `host-error` that says `what` happened; the next run tries it again."""
        message = f"This is not your fault: {what}"
        grade = replace(
            entry.grade, outcome="host-error", message=message, score=0.0, verdicts=(), recordings={}, references={}
        )
        self.entries[entry.student.id] = entry = replace(entry, grade=grade, adjustments=(), submitted=None)
        self.results.forget(entry.student.id)
        return entry

    def keep(self, handed_in: HandedIn, marked: Marked, submission: Submission) -> Entry:
        """Write a grade with its page into the student's folder."""
        # Who grades may see the file under another name.
        grade = replace(marked.grade, submission=handed_in.file.name)
        entry = self._entry(handed_in, Entry(handed_in.student, handed_in.file.name, grade))
        key = "" if grade.outcome == "host-error" else self._key(submission)
        if grade.recordings and self.grading:
            recorded = recordings_key(self.grading, submission)
            self.results.keep_recordings(entry.student.id, recorded, grade.recordings)
        self.results.write(entry, key, feedback_page(entry, self.exercise, marked.plot), marked.plot)
        # What was recorded is in the page now; kept for a whole class, it would fill the memory.
        self.entries[entry.student.id] = entry = replace(entry, grade=replace(grade, recordings={}, references={}))
        return entry

    def _still(self, handed_in: HandedIn, kept: Entry, key: str) -> Entry:
        try:
            return self._unchanged(handed_in, kept, key)
        except Exception as error:
            return self.give_up(Entry(handed_in.student, handed_in.file.name, kept.grade), not_written(error))

    def _unchanged(self, handed_in: HandedIn, kept: Entry, key: str) -> Entry:
        """The entry of a submission that needs no grading: who handed it in and when may have changed all the same."""
        entry = self._entry(handed_in, kept)
        plot = self.results.plot(entry.student.id)
        self.results.write(entry, key, feedback_page(entry, self.exercise, plot), plot)
        return entry

    def _entry(self, handed_in: HandedIn, of: Entry) -> Entry:
        file = handed_in.file
        entry = replace(
            of,
            student=handed_in.student,
            file=file.name,
            grade=replace(of.grade, submission=file.name),
            submitted=file.submitted,
            submitted_from=file.submitted_from if file.submitted else "",
            adjustments=(),
        )
        entry = replace(entry, adjustments=self.adjust(entry))
        self.entries[entry.student.id] = entry
        return entry

    def _key(self, submission: Submission) -> str:
        return with_submission(self.markers.key, f"{submission.digest} {submission.warning}")


def not_written(error: Exception) -> str:
    """Say that a student's results could not be written."""
    return f"the results could not be written: {type(error).__name__}: {error}"
