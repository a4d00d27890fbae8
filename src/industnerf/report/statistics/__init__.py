"""Intervals, paired tests, and variance over seeds."""
