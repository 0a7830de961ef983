"""Would this rig's effects be seen? Simulated rigs with a user's own inputs, sensors and beliefs are diagnosed."""
