"""Mutants: copies of a right program, each changed in one place, as a student might get it wrong."""

from grader.audit.mutants.maker import Mutant, mutants_of

__all__ = ["Mutant", "mutants_of"]
