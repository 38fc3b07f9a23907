"""Loads that bring a given design to a given posture or force."""

from flexor.inverse.solution import Reach, reach
from flexor.inverse.target import Target, targets

__all__ = ["Reach", "Target", "reach", "targets"]
