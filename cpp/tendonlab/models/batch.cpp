#include "tendonlab/models/batch.hpp"

#include <algorithm>
#include <map>

#include "tendonlab/core/error.hpp"

namespace tendonlab {
namespace {
/// Row `i` of numbers that belong to the points, `width` a row.
template <class To, class From>
void read_row(const From* from, std::size_t i, std::size_t width, To& to) {
  to.assign(from + i * width, from + (i + 1) * width);
}
void require_allowed(const SystemInfo& info, const Configuration& with) {
  for (std::size_t k = 0; k < with.values.size(); ++k) {
    const ParameterInfo& p = info.parameters[k];
    require_within(p.name, with.values[k], p.lower, p.upper, "");
  }
}
/// Fills the caller's array: doubles are written there at once, floats when their point has ended.
template <class Real>
class Filling final : public PointSink {
 public:
  Filling(const Outputs<Real>& into, std::size_t all, std::size_t num_samples, std::size_t points)
      : out(into), channels(all), samples(num_samples), said(points) {}
  integrate::Trajectory::Rows rows(std::size_t point) override {
    integrate::Trajectory::Rows to(channels, nullptr);
    double* row = begin(point);
    for (const std::size_t channel : out.channels) to[channel] = row, row += samples;
    return to;
  }
  void done(std::size_t point, const std::string& message) override {
    said[point] = message;
    Real* to = out.to + point * cells();
    if constexpr (!std::is_same_v<Real, double>) {
      const auto from = waiting.extract(point);
      std::transform(from.mapped().begin(), from.mapped().end(), to, [](double x) { return static_cast<Real>(x); });
    }
    if (!message.empty()) std::fill_n(to, cells(), std::numeric_limits<Real>::quiet_NaN());
  }
  std::vector<std::string> messages() && { return std::move(said); }

 private:
  std::size_t cells() const { return out.channels.size() * samples; }
  double* begin(std::size_t point) {
    if constexpr (std::is_same_v<Real, double>)
      return out.to + point * cells();
    else
      return waiting.emplace(point, std::vector<double>(cells())).first->second.data();
  }

  const Outputs<Real>& out;
  const std::size_t channels, samples;
  std::vector<std::string> said;
  std::map<std::size_t, std::vector<double>> waiting;  ///< outputs of the points that run
};
}  // namespace

Configuration configuration(const SystemInfo& of, const Points& points, std::size_t point) {
  Configuration with;
  read_row(points.values, point, of.parameters.size(), with.values);
  read_row(points.active, point, of.effects.size(), with.active);
  require_allowed(of, with);
  return with;
}

template <class Real>
std::vector<std::string> simulate_batch(const Model& model, const Points& points,
                                        const integrate::Experiment& experiment, const integrate::Settings& settings,
                                        const Outputs<Real>& out) {
  const std::size_t flags = model.info().effects.size();
  std::map<std::vector<bool>, std::vector<std::size_t>> alike;  // points with the same effects share lanes
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::uint8_t* active = points.active + i * flags;
    alike[std::vector<bool>(active, active + flags)].push_back(i);
  }
  Filling<Real> sink(out, model.info().outputs.size(), experiment.time.size(), points.count);
  for (const auto& group : alike) model.simulate_points(points, group.second, experiment, settings, sink);
  return std::move(sink).messages();
}
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<double>&);
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<float>&);
}  // namespace tendonlab
