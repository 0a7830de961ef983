"""The five papers in their own notation: constants, rigs, experiments and twins (S0 … S4 in the documentation)."""
