"""A simulator with numbers in it, the signals it is given and the runs it gives."""
