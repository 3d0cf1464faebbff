"""Draws a recording: a panel for each kind of quantity, a curve for each joint, axes with units."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

from spinbook.runtime.plot.recording import Curve, Recording

#: Told apart in grey and by readers who do not see red and green alike (after Okabe and Ito, 2008).
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
_DASHES = ["-", "--", "-.", ":"]


def draw(recording: Recording, title: str = "") -> Figure:
    """A figure of what was recorded. Time counts from the first sample."""
    shown = panels(recording)
    figure = Figure(figsize=(8, 1.2 + 2.6 * len(shown)), layout="constrained")
    axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    several_topics = len({curve.quantity.topic for curve in recording.curves.values()}) > 1
    for axis, ((kind, unit), curves) in zip(axes, shown.items(), strict=True):
        for number, curve in enumerate(curves):
            label = f"{curve.quantity.topic} {curve.quantity.label}" if several_topics else curve.quantity.label
            axis.plot(
                [time - recording.start for time in curve.times],
                curve.values,
                color=COLOURS[number % len(COLOURS)],
                linestyle=_DASHES[number // len(COLOURS) % len(_DASHES)],
                linewidth=1.6,
                marker="." if len(curve.times) < 40 else None,
                markersize=4,
                label=label,
            )
        axis.set_ylabel(f"{kind.replace('_', ' ')} ({unit})" if unit else kind.replace("_", " "))
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
        axis.margins(x=0.01)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    axes[-1].set_xlabel("time (s)")
    figure.suptitle(title or ", ".join(dict.fromkeys(c.quantity.topic for c in recording.curves.values())), fontsize=11)
    return figure


def panels(recording: Recording) -> dict[tuple[str, str], list[Curve]]:
    """(kind, unit) -> the curves that share an axis, in the order in which they first appeared."""
    panels: dict[tuple[str, str], list[Curve]] = {}
    for quantity, curve in recording.curves.items():
        panels.setdefault((quantity.kind, quantity.unit), []).append(curve)
    return panels


def in_words(recording: Recording) -> str:
    """What the figure shows, for those who can't see it and for front ends without pictures."""
    lines = []
    for (kind, unit), curves in panels(recording).items():
        for curve in curves:
            low, high = min(curve.values), max(curve.values)
            span = f"{low:.3f} … {high:.3f} {unit}".rstrip()
            lines.append(f"{kind} {curve.quantity.label}: {len(curve.values)} samples, {span}")
    return "\n".join(lines)


def as_png(figure: Figure) -> bytes:
    """The figure as a PNG, without the date or the version of what drew it."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=110, metadata={"Software": None})
    return out.getvalue()
