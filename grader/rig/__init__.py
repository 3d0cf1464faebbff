"""The rig spins a node: it owns the clock, publishes what the scenario says and records what comes back."""
