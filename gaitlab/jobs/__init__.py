"""Durable jobs: queue, worker, one process per computation."""
