#include "tendonlab/models/model.hpp"

#include "tendonlab/core/error.hpp"
#include "tendonlab/systems/all.hpp"

namespace tendonlab {
template <template <class> class Of>
std::unique_ptr<Model> make_model();

namespace {
/// Was the system chosen when the library was configured? TENDONLAB_SYSTEMS: ",one,two,"; ",," builds all.
constexpr bool is_built(std::string_view kind) {
  constexpr std::string_view chosen = TENDONLAB_SYSTEMS;
  for (std::size_t i = chosen.find(kind); i != chosen.npos; i = chosen.find(kind, i + 1))
    if (chosen[i - 1] == ',' && chosen[i + kind.size()] == ',') return true;
  return chosen == ",,";
}
template <template <class> class Of>
void add(std::vector<std::unique_ptr<Model>>& all) {
  if constexpr (is_built(Of<double>::name)) all.push_back(make_model<Of>());
}
template <template <class> class... Of>
std::vector<std::unique_ptr<Model>> make(Laws<Of...>) {
  std::vector<std::unique_ptr<Model>> all;
  (add<Of>(all), ...);
  return all;
}
}  // namespace

std::size_t seeds_at_once() {
  return most_directions;
}
const std::vector<std::unique_ptr<Model>>& models() {
  static const auto all = make(systems::All{});
  return all;
}

const Model& model(const std::string& kind) {
  std::string known;
  for (const auto& m : models()) {
    if (m->info().kind == kind) return *m;
    known += (known.empty() ? "" : ", ") + m->info().kind;
  }
  throw ParameterError(sentence("system kind = \"", kind, "\": expected one of ", known));
}
}  // namespace tendonlab
