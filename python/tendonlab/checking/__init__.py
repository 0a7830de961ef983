"""Whether logs can be trusted: signs, scales, clocks, samples."""
