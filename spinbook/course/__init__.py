"""A course: what course.toml says."""
