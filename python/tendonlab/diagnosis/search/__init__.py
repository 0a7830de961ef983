"""Which effects: candidates screened, refitted, contested by rivals, and selected."""
