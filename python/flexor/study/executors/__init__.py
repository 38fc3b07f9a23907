"""Executors: where the designs of studies are evaluated."""

from __future__ import annotations

from flexor.study.executors.choice import AnyExecutor, chosen_executor
from flexor.study.executors.cluster import Cluster
from flexor.study.executors.interface import Executor, Threads
from flexor.study.executors.pool import Pool

__all__ = ["AnyExecutor", "Cluster", "Executor", "Pool", "Threads", "chosen_executor"]
