#pragma once
// The parameters of `tendon_routing`, one per pulley, branch or motor: "radius_2_1" is that of transmission 2 at
// joint 1, "viscous_loss_2_0" is on its link 0, the base. They are made by rules, since nobody reads a list of 52 rows.
#include <array>
#include <utility>

#include "tendonlab/core/parameter.hpp"

namespace tendonlab::systems::tendon {
inline constexpr std::size_t joints = 4, branches = joints * (joints + 1) / 2;
/// Index of transmission i's branch on link j (or of its pulley at joint j), j <= i, in lists of all branches.
constexpr std::size_t cell(std::size_t i, std::size_t j) {
  return i * (i + 1) / 2 + j;
}
constexpr std::size_t row_of(std::size_t cell) {
  std::size_t i = 0;
  while ((i + 1) * (i + 2) / 2 <= cell) ++i;
  return i;
}

/// A kind of parameter; where it is not named it is 0 if `typical` is. `first` is the number of the first joint (1) or
/// link (0), -1 where there is one per motor.
struct Kind {
  std::string_view name;
  Dimension dimension;
  double typical, lower, upper;
  int first;
  std::string_view meaning;
};
enum KindOf { radius, constant_loss, tension_loss, viscous_loss, motor_radius, reducer_ratio, reducer_efficiency };
inline constexpr Kind kinds[] = {
    {"radius", Dimension::length, 0.05, -inf, inf, 1,
     "signed radius of the pulley of a transmission at a joint; at its own joint without the reducer's ratio"},
    {"constant_loss", Dimension::force, 0.0, 0.0, inf, 0, "tension lost on a link whatever the tension"},
    {"tension_loss", Dimension::ratio, 0.0, 0.0, 0.999, 0, "tension lost on a link per tension before it"},
    {"viscous_loss", Dimension::line_damping, 0.0, 0.0, inf, 0, "tension lost on a link per speed of the cable"},
    {"motor_radius", Dimension::length, 0.01, 1e-9, inf, -1, "radius of the motor's pulley"},
    {"reducer_ratio", Dimension::ratio, 1.0, 1e-9, inf, -1, "ratio of the reducer on the driven pulley; 1: none"},
    {"reducer_efficiency", Dimension::ratio, 1.0, 0.5, 1.0, -1, "efficiency of that reducer while driving"}};
inline constexpr std::size_t triangles = 4, count = triangles * branches + 3 * joints;
constexpr std::size_t kind_of(std::size_t k) {
  return k < triangles * branches ? k / branches : triangles + (k - triangles * branches) / joints;
}
constexpr std::size_t place_of(std::size_t k) {
  return k < triangles * branches ? k % branches : (k - triangles * branches) % joints;
}
constexpr std::size_t index_of(KindOf kind, std::size_t place) {
  const auto of = static_cast<std::size_t>(kind);
  return of < triangles ? of * branches + place : triangles * branches + (of - triangles) * joints + place;
}

struct Text {
  char letters[32] = {};
  std::size_t size = 0;
  constexpr void add(std::string_view more) {
    for (const char c : more) letters[size++] = c;
  }
  constexpr void add(std::size_t digit) { letters[size++] = static_cast<char>('0' + digit); }
};
constexpr Text numbered(std::string_view name, std::size_t i) {
  Text text;
  text.add(name), text.add("_"), text.add(i);
  return text;
}
constexpr Text numbered(std::string_view name, std::size_t i, std::size_t j) {
  Text text = numbered(name, i);
  text.add("_"), text.add(j);
  return text;
}
constexpr Text name_of(std::size_t k) {
  const Kind& kind = kinds[kind_of(k)];
  const std::size_t place = place_of(k);
  if (kind.first < 0) return numbered(kind.name, place + 1);
  const std::size_t i = row_of(place);
  return numbered(kind.name, i + 1, place - cell(i, 0) + static_cast<std::size_t>(kind.first));
}
template <std::size_t k>
struct Named {
  static constexpr Text text = name_of(k);
  static constexpr std::string_view name{text.letters, text.size};
};

template <class T, std::size_t k>
struct Entry {
  T value{};
};
/// A value for each row of the table.
template <class T, class Indices>
struct EntriesOf;
template <class T, std::size_t... k>
struct EntriesOf<T, std::index_sequence<k...>> : Entry<T, k>... {
  std::array<T, count> values() const { return {Entry<T, k>::value...}; }
};
template <class T>
using Entries = EntriesOf<T, std::make_index_sequence<count>>;

template <class Owner, class T, std::size_t... k>
constexpr auto table(std::index_sequence<k...>) {
  const auto row = [](auto index) {
    constexpr std::size_t i = decltype(index)::value;
    constexpr const Kind& kind = kinds[kind_of(i)];
    constexpr bool crossed = kind_of(i) == radius && place_of(i) != cell(row_of(place_of(i)), row_of(place_of(i)));
    T Owner::*field = &Entry<T, i>::value;
    return parameter(field, Named<i>::name, kind.dimension, Purpose::structure, crossed ? 0.0 : kind.typical,
                     kind.lower, kind.upper, kind.meaning);
  };
  return std::tuple{row(std::integral_constant<std::size_t, k>{})...};
}
}  // namespace tendonlab::systems::tendon
