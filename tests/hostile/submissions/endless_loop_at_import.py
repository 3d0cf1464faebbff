"""Never gets to its first import."""

while True:
    pass
