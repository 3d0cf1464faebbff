"""An autograder for Classroom 50, GitHub Classroom's successor, and for GitHub Actions in any repository."""
