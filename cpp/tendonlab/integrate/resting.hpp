#pragma once
// What rests stays at rest until a push breaks it away: its state is known in advance.
#include "tendonlab/integrate/rate.hpp"

namespace tendonlab::integrate {
/// The shortest time that counts at `time`.
inline double resolution(double time) {
  return 1e-13 * (1.0 + std::fabs(time));
}
/// Do the sticking ports hold every part, and does none move?
template <class System>
bool all_rest(const StateOf<System, double>& y, const Frame<System, double>& frame) {
  bool rest = frame.holds;
  for (std::size_t j = 0; j < System::dof && rest; ++j) {
    rest = y.at.velocity[j] == 0.0;
    for (const double let_through : frame.keep[j]) rest = rest && let_through == 0.0;
  }
  return rest;
}
/// Up to when a step from `now` may go: up to `last` if the modes hold at all knots before it, else up to the last knot
/// before the one at which they do not, or to the first knot.
template <class Drive, class Holds>
double end_of_rest(const Drive& drive, double now, double last, Holds&& hold_at) {
  double knot = drive.next_knot(now + resolution(now)), until = knot;
  for (; knot < last && hold_at(knot); knot = drive.next_knot(knot + resolution(knot))) until = knot;
  return knot < last ? until : last;
}
}  // namespace tendonlab::integrate
