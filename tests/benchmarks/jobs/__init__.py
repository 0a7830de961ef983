"""What is measured: each module has a `run` that takes options and gives tables."""
