"""Prints the beginning of a traceback that is slow to search, and gives up."""

import os

print('Traceback (most recent call last):')
print(f'  File "forges_a_traceback.py", line {"1" * 5000}')
print('Traceback (most recent call last):' + ' \n' * 60_000, flush=True)
os._exit(1)
