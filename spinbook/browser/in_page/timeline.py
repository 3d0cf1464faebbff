"""`%timeline` in a page: one process records, and the process of plain cells draws."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence


def record(names: Sequence[str]) -> None:
    """Print every event of these services, actions and topics, until interrupted."""
    from spinbook.kernel import timeline_recorder

    sys.argv = ["timeline", *names]
    timeline_recorder.main()


def drawn(names: Sequence[str], lines: Iterable[str], title: str) -> dict[str, str]:
    """Return the picture of what was recorded: `picture`, `words` and `problem`, "" if there is none."""
    from spinbook.kernel.timeline import RecordedEvents, in_words, lanes
    from spinbook.kernel.timeline_picture import span_of, timeline_svg

    recorded = RecordedEvents()
    recorded.take(lines)
    kinds = recorded.kinds
    recorded.kinds = {name: kinds[name] for name in names if name in kinds}
    drawn_lanes = lanes(recorded)
    if recorded.error or not any(lane.marks for lane in drawn_lanes):
        nothing = f"Nothing has happened on {', '.join(names)} since `%timeline --record`."
        return {"picture": "", "words": "", "problem": recorded.error or nothing}
    words = in_words(drawn_lanes, span_of(drawn_lanes)[0])
    return {"picture": timeline_svg(drawn_lanes, title), "words": words, "problem": ""}
