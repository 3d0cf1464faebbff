"""The messages, services and actions of a course: collecting, compiling and using them."""
