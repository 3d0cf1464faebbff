"""Moving pictures as SVG, moved by CSS alone: no script; in print and for still readers, the last picture."""
