"""The sections of a report, one file per question that a reader asks."""
