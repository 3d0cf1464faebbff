"""Sleeps before it creates its node."""

import time

time.sleep(3600)
