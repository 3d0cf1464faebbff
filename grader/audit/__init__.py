"""Shows that an exercise's checks catch what is wrong and pass what is right."""
