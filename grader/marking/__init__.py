"""Grades a whole class: many submissions at once, each once, going on where an earlier run was stopped."""
