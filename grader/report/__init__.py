"""Shows a grade: to people, to programs, as a plot and as a bag."""
