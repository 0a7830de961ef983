"""Where the sim-to-real gap lies, which unmodelled effect causes it, and how far it shrinks once that is added."""
