"""Saved in Latin-1, with no word about it: größer."""

print('größer')
