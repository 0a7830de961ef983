"""What the report says of a search: where, which, how far, and what to measure next."""
