"""Internal consistency of a scale: Cronbach's α and what goes with it, McDonald's ω."""

from survey.analysis.consistency.cronbach import Reliability, reliability, reliability_of
from survey.analysis.consistency.mcdonald import HEYWOOD, Omega, omega_of, one_factor

__all__ = ["HEYWOOD", "Omega", "Reliability", "omega_of", "one_factor", "reliability", "reliability_of"]
