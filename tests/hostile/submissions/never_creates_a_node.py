"""Does something else altogether."""

print("Hello, world!")
