"""What identification and diagnosis share: noise, priors, the posed fit, the fitted model and its uncertainty."""
