"""An audit for people and programs."""
