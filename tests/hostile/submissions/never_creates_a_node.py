"""Does something entirely different."""

print("Hello, world!")
