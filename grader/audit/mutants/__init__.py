"""Mutants: a right program, each changed in one place, as a student might get it wrong."""

from grader.audit.mutants.making import mutants_of
from grader.audit.mutants.mutant import Mutant

__all__ = ["Mutant", "mutants_of"]
