// Laws behind one interface of plain numbers: the templates end here.
#include "tendonlab/models/laws.hpp"

#include <map>
#include <typeindex>

#include "tendonlab/core/chain.hpp"
#include "tendonlab/models/groups.hpp"

namespace tendonlab {
ParameterInfo own_parameter(const Row& p) {
  const std::string name(p.name);
  return {name,    {},      std::string(p.effect), name, p.dimension, p.purpose, p.role, p.typical,
          p.lower, p.upper, std::string(p.meaning)};
}

namespace {
template <class Law, class = void>
struct PartnerOf {
  static constexpr std::string_view name = Law::name;
};
template <class Law>
struct PartnerOf<Law, std::void_t<typename Law::Partner>> {
  static constexpr std::string_view name = Law::Partner::name;
};
double sign_between(double above, double below) {
  return static_cast<double>((above > 0) - (below < 0));
}
/// What a law sees: Sliding or Passing, or a port or signal of its own with more fields.
template <class L, class = void>
struct PortOf {
  using type = std::conditional_t<(L::roles & role::signal) != 0, Passing<double>, Sliding<double>>;
};
template <class L>
struct PortOf<L, std::void_t<typename L::template Port<double>>> {
  using type = typename L::template Port<double>;
};
template <class L>
struct PortOf<L, std::void_t<typename L::template Signal<double>>> {
  using type = typename L::template Signal<double>;
};

template <class L>
class BoxOf final : public LawBox {
  using Port = typename PortOf<L>::type;
  L law{};
  static constexpr bool plays(unsigned wanted) { return (L::roles & wanted) != 0; }

 public:
  explicit BoxOf(const Numbers& values) {
    auto next = values.begin();
    for_each_parameter<L>([&](const auto& p) { law.*p.field = *next++; });
  }
  double level(const Numbers& port) const override {
    if constexpr (plays(role::level)) return law.level(port_of(port));
    return static_cast<void>(port), 0.0;
  }
  double factor(const Numbers& port) const override {
    if constexpr (plays(role::factor)) return law.factor(port_of(port));
    return static_cast<void>(port), 0.0;
  }
  double gain(const Numbers& port) const override {
    if constexpr (plays(role::gain)) return law.gain(port_of(port));
    return static_cast<void>(port), 0.0;
  }
  double force(const Numbers& port) const override {
    double sum = 0;
    if constexpr (plays(role::level | role::force)) {
      const Port at = port_of(port);
      if constexpr (plays(role::level)) sum += at.direction * law.level(at);
      if constexpr (plays(role::force)) sum += law.force(at);
    }
    return static_cast<void>(port), sum;
  }
  Numbers motion(const Numbers& port) const override {
    Numbers behind = port;
    if constexpr (plays(role::motion)) {
      const auto moved = law.motion(port_of(port));
      auto next = behind.begin();
      moved.for_each_field([&](std::string_view, unsigned, auto access) { *next++ = access(moved); });
    }
    return behind;
  }
  double state_rate(const Numbers& moving) const override {
    if constexpr (plays(role::memory)) return law.state_rate(sliding_of(moving), moving[2], moving[1]);
    return static_cast<void>(moving), 0.0;
  }
  double state_force(const Numbers& moving) const override {
    double sum = 0;
    if constexpr (plays(role::memory)) {
      const auto at = sliding_of(moving);
      double left = 1.0;  // share of the dry friction that the memory leaves to the slot
      if constexpr (takes_over_dry_friction<L>) left = law.dry_share();
      sum = law.state_force(at, moving[1], state_rate(moving)) + at.direction * left * moving[2];
    }
    return static_cast<void>(moving), sum;
  }
  Numbers pass(const std::vector<Numbers>& samples, const Numbers& dt) const override {
    Numbers behind;
    if constexpr (plays(role::signal) && !delays_signal<L>) {
      typename StateOf<L, double>::type state{};
      for (const Numbers& sample : samples) {
        Port at = filled(sample);
        if constexpr (keeps_state<L>) at.dt = dt[behind.size()];
        behind.push_back(signal_behind(law, at, state));
      }
    }
    return static_cast<void>(samples), static_cast<void>(dt), behind;
  }
  double lateness() const override {
    if constexpr (delays_signal<L>) return law.lateness();
    return 0.0;
  }

 private:
  static Port filled(const Numbers& fields) {
    Port at;
    auto next = fields.begin();
    at.for_each_field([&](std::string_view, unsigned, auto access) { access(at) = *next++; });
    return at;
  }
  /// The port with the modes that a stepper would hold: they follow from the motion, 0 at rest.
  Port port_of(const Numbers& fields) const {
    Port at = filled(fields);
    at.direction = sign_between(at.velocity, at.velocity);
    if constexpr (opens_gap<L>) at.side = sign_between(at.position - law.half_gap(), at.position + law.half_gap());
    return at;
  }
  static Sliding<double> sliding_of(const Numbers& moving) {
    Sliding<double> at;
    at.velocity = moving[0], at.load = moving[3];
    at.direction = sign_between(at.velocity, at.velocity);
    return at;
  }
};

template <class L>
std::unique_ptr<const LawBox> make_box(const Numbers& values) {
  return std::make_unique<BoxOf<L>>(values);
}
template <class L>
LawFacts facts_of(std::string_view group) {
  LawFacts facts{
      group,    L::name, L::noun,          L::equation,    L::source, L::summary,          PartnerOf<L>::name,
      L::roles, L::sees, delays_signal<L>, keeps_state<L>, {},        own_parameters<L>(), &make_box<L>};
  PortOf<L>::type::for_each_field([&](std::string_view name, unsigned, auto) { facts.fields.emplace_back(name); });
  for (ParameterInfo& p : facts.parameters) p.effect = L::name;
  return facts;
}

using FactsByType = std::map<std::type_index, const LawFacts*>;
FactsByType facts_by_type() {
  FactsByType all;
  auto group = law_groups().begin();
  for_each_group([&](const char*, const char*, auto list) {
    auto facts = (group++)->laws.begin();
    list.for_each([&](auto* law) { all[typeid(*law)] = &*facts++; });
  });
  return all;
}
}  // namespace

const std::vector<LawGroup>& law_groups() {
  static const auto all = [] {
    std::vector<LawGroup> groups;
    for_each_group([&](const char* name, const char* doc, auto list) {
      groups.push_back({name, doc, {}});
      list.for_each(
          [&](auto* law) { groups.back().laws.push_back(facts_of<std::remove_pointer_t<decltype(law)>>(name)); });
    });
    return groups;
  }();
  return all;
}

const LawFacts& law_facts(const std::type_info& law) {
  static const FactsByType all = facts_by_type();
  const auto found = all.find(law);
  if (found == all.end()) throw std::logic_error("a law that is in no group (models/groups.hpp)");
  return *found->second;
}
}  // namespace tendonlab
