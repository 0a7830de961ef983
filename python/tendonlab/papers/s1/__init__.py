"""S1: tension propagation with friction in coupled tendon transmissions of a four-joint arm exoskeleton.

The device's radii, ratios and coefficients are reconstructed, the paper prints none, and so is what rests on them."""
