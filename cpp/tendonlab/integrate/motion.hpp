#pragma once
// A measured motion, and what the equation of motion says along it: plain data, the same for every system.
#include <vector>

namespace tendonlab::integrate {
/// Position and velocity of each degree of freedom whose state is stated: [degree of freedom][sample].
struct MeasuredMotion {
  std::vector<double> position, velocity;
};
/// What laws and inputs exert on each degree of freedom, and its inertia: [degree of freedom][sample]. What the sensors
/// then read: [channel][sample]. Effort = inertia·acceleration where the system describes the rig.
struct Balance {
  std::vector<double> effort, inertia, output;
};
}  // namespace tendonlab::integrate
