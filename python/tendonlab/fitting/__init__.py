"""What identification and diagnosis share.

`noise`: what the sensors and the model's errors add to a record. `priors`: what is free, and what is believed of it.
`case`: the experiments of a fit, ready to be simulated. `floor`: the noise that repeated runs show.
`problem`: a model posed against a case. `fitted`: the model at its optimum, and what it is worth. `uncertainty`: how
far its values can be trusted."""
