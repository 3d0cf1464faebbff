"""Runs one program through one scenario, and records what it does."""
