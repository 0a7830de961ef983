// A gap followed by a law that changes the motion in another way: the gap of the slot is that of the first.
#include "tendonlab/core/slot.hpp"
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/ripple.hpp"

using namespace tendonlab;

int main() {
  Slot<double, Laws<transmission::Backlash, transmission::Ripple>> slot{};
  std::get<0>(slot.laws).backlash = 0.3;
  slot.active = 0b01;
  const bool alone = slot.half_gap() == 0.15;
  slot.active = 0b11;
  const bool with_ripple = slot.half_gap() == 0.15;
  slot.active = 0b10;
  const bool without_gap = slot.half_gap() == 0.0;
  return alone && with_ripple && without_gap ? 0 : 1;
}
