#pragma once
// Ports and signals of `tendon_routing`, by the same rules as its parameters: cable_2_1 is transmission 2 on link 1.
#include "tendonlab/systems/system.hpp"
#include "tendonlab/systems/tendon_table.hpp"

namespace tendonlab::systems::tendon {
/// A table of texts that lives as long as the program, so that string views may refer to it.
template <std::size_t size>
struct Texts {
  Text text[size] = {};
  constexpr std::string_view operator[](std::size_t i) const { return {text[i].letters, text[i].size}; }
};
/// `name`_1 to `name`_4.
constexpr Texts<joints> numbered_texts(std::string_view name) {
  Texts<joints> all;
  for (std::size_t i = 0; i < joints; ++i) all.text[i] = numbered(name, i + 1);
  return all;
}
constexpr Texts<branches> cable_texts() {
  Texts<branches> all;
  for (std::size_t i = 0; i < joints; ++i)
    for (std::size_t j = 0; j <= i; ++j) all.text[cell(i, j)] = numbered("cable", i + 1, j);
  return all;
}
/// `before` 1 `after` to `before` 4 `after`.
constexpr Texts<joints> sentences(std::string_view before, std::string_view after = {}) {
  Texts<joints> all;
  for (std::size_t i = 0; i < joints; ++i) all.text[i].add(before), all.text[i].add(i + 1), all.text[i].add(after);
  return all;
}
inline constexpr auto cable_names = cable_texts();
inline constexpr auto gear_names = numbered_texts("gear"), velocity_names = numbered_texts("motor_velocity"),
                      needed_names = numbered_texts("external_torque"), torque_names = numbered_texts("motor_torque");
inline constexpr auto velocity_meanings = sentences("velocity of motor "),
                      needed_meanings = sentences("torque that joint ", " needs"),
                      torque_meanings = sentences("torque of motor ");

/// The branches of all transmissions, then the reducers.
constexpr std::array<Port, branches + joints> ports() {
  std::array<Port, branches + joints> all{};
  for (std::size_t b = 0; b < branches; ++b) all[b] = port("cable").named(cable_names[b]).along(Axis::linear);
  for (std::size_t i = 0; i < joints; ++i) all[branches + i] = port("gear").named(gear_names[i]).along(Axis::rotary);
  return all;
}
/// The first motor moves on every device. Users are warned where a signal of another one is absent and matters.
constexpr std::array<Input, 2 * joints> inputs() {
  std::array<Input, 2 * joints> all{};
  for (std::size_t i = 0; i < joints; ++i) {
    const Input velocity = input(velocity_names[i], Dimension::angular_speed, Between::linear, velocity_meanings[i]);
    all[i] = i == 0 ? velocity.required() : velocity.warn_if_absent();
    all[joints + i] = input(needed_names[i], Dimension::torque, Between::linear, needed_meanings[i]).warn_if_absent();
  }
  return all;
}
constexpr std::array<Output, joints> outputs() {
  std::array<Output, joints> all{};
  for (std::size_t i = 0; i < joints; ++i) all[i] = output(torque_names[i], Dimension::torque, torque_meanings[i]);
  return all;
}
}  // namespace tendonlab::systems::tendon
