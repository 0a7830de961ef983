#include "tendonlab/systems/model.hpp"

#include "tendonlab/core/error.hpp"
#include "tendonlab/systems/all.hpp"

namespace tendonlab {
template <template <class> class Of>
std::unique_ptr<Model> make_model();

namespace {
template <template <class> class... Of>
std::vector<std::unique_ptr<Model>> make(Laws<Of...>) {
  std::vector<std::unique_ptr<Model>> all;
  (all.push_back(make_model<Of>()), ...);
  return all;
}
}  // namespace

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
