"""The messages, services and actions of a course: collected, compiled, and used wherever its nodes run."""
