#pragma once
// What a system states of itself, as plain data: its own facts, then place by place those of its laws.
#include <string>
#include <vector>

#include "tendonlab/models/assemble.hpp"
#include "tendonlab/models/laws.hpp"

namespace tendonlab {
/// The tables of a system, and which public parameter each field is, in the order of the walk (assemble.hpp).
struct Description {
  SystemInfo info{};
  std::vector<std::size_t> parameter_of_field;
};

namespace systems {
/// The flags of `count` effects from `first` on, one bit each.
unsigned active_bits(const Configuration& of, std::size_t first, std::size_t count);

/// One of the tables of a system, which live as long as the program.
template <class Row>
struct Table {
  const Row* first;
  std::size_t count;
  template <std::size_t n>
  Table(const std::array<Row, n>& of) : first(of.data()), count(n) {}
  const Row* begin() const { return first; }
  const Row* end() const { return first + count; }
};
/// A system as it states itself.
struct SystemFacts {
  std::string_view name, equation;
  int stated;
  bool commanded, sampled, steady, plain_names;
  Table<Input> inputs;
  Table<Output> outputs;
  Table<Port> ports;
  Table<std::string_view> structural, nominal;
  Table<Renamed> renamed;
  Table<Place> places;
  std::string_view passing;
  bool load, actuation, sensors;  ///< do laws sit there?
};

/// Builds a description, fact by fact.
class Describe {
 public:
  explicit Describe(SystemFacts of);
  void add_own(const std::vector<ParameterInfo>& parameters);
  /// The next place in the order of the walk.
  void add_place(const std::vector<const std::type_info*>& laws);
  Description made() && { return std::move(description); }

 private:
  std::vector<std::string> place_names() const;
  void add_law(const LawFacts& law);
  /// The index of a public parameter; a law's partner may have stated it before.
  std::size_t add(std::string_view partner, ParameterInfo own);
  const Place* find_place() const;
  std::string place_words() const;
  std::string acts_on() const;
  std::string axis() const;
  std::string effect_name(std::string_view law) const { return element + ":" + std::string(law); }
  std::string parameter_name(std::string_view law, std::string_view own) const;
  bool is_structural(const std::string& effect) const;
  ParameterInfo under_load(ParameterInfo p) const;

  Description description;
  const SystemFacts system;
  const std::vector<std::string> names = place_names();
  std::vector<std::string>::const_iterator next_place = names.begin();
  std::string element;
};

template <class... Slot>
constexpr int states_of(const std::tuple<Slot...>*) {
  return (Slot::states + ... + 0);
}
/// Sampled, and no sample depends on another.
template <class System>
constexpr bool is_steady() {
  if constexpr (System::sampled)
    return states_of(static_cast<decltype(System::slot)*>(nullptr)) == 0 && std::is_empty_v<typename System::Carried>;
  else
    return false;
}
template <class System>
SystemFacts system_facts() {
  return {System::name,
          System::equation,
          stated<System>,
          System::commanded,
          System::sampled,
          is_steady<System>(),
          System::plain_names,
          System::inputs,
          System::outputs,
          System::ports,
          System::structural,
          System::nominal,
          System::renamed,
          System::places,
          System::passing,
          decltype(System::load)::size > 0,
          decltype(System::actuation)::size > 0,
          decltype(System::sensor)::value_type::size > 0};
}
template <class... Law>
std::vector<const std::type_info*> types_of(const std::tuple<Law...>&) {
  return {&typeid(Law)...};
}
template <class System>
Description describe() {
  Describe all(system_facts<System>());
  all.add_own(own_parameters<System>());
  System system{};
  for_each_place(system, [&](auto& laws, unsigned) { all.add_place(types_of(laws)); });
  return std::move(all).made();
}
}  // namespace systems
}  // namespace tendonlab
