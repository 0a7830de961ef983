"""Formulas of mechanisms that systems and researchers share: tendon routing, Bowden pairs, bond graphs."""
