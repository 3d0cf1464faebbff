"""Never comes to its first import."""

while True:
    pass
