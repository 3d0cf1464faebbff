"""What is wrong, as a table of facts, and as the caption of a plot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from grader.checking.verdict import Finding
from grader.recording.recording import Recording
from grader.report.checks import ShownCheck
from grader.report.feedback import described


def facts(
    finding: Finding, recordings: Mapping[str, Recording], element: str
) -> tuple[tuple[tuple[str, str], ...], str]:
    """Return what is wrong as (label, value), and the rest of the finding's text."""
    phrase = f"got {finding.got}."
    if not (finding.expected and finding.got and phrase in finding.text):
        return (), finding.text
    before, _, after = finding.text.partition(phrase)
    pairs = [("expected", finding.expected), ("got", finding.got)]
    if finding.message is not None:
        recording = recordings.get(finding.scenario)
        of = f" of {len(recording.sent)}" if recording else ""
        pairs.append(("when", f"{finding.at or 0.0:.2f} s after the start (message {finding.message}{of})"))
        before = ""
    if finding.part:
        pairs.append((element, finding.part))
    # "Your subscription has another type. Expected …" keeps its first sentence.
    remark = f"{before.rpartition('Expected ')[0].strip()} {after.strip()}".strip()
    return tuple(pairs), remark


def plot_says(checks: Iterable[ShownCheck], plot: str) -> str:
    """Return what the plot next to these checks shows; `plot` is its SVG."""
    for check in checks:
        if check.finding and check.finding.message is not None:
            where = f", {check.finding.part}" if check.finding.part else ""
            return f"Yours over the solution's. First wrong: {check.finding.at or 0.0:.2f} s{where}."
    return described(plot)
