"""Fitting the free parameters of a simulator to logs."""
