#include "tendonlab/identify/whitening.hpp"

#include <cmath>

#include "tendonlab/core/columns.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::identify {
Whitening::Whitening(std::vector<ChannelNoise> channel_noise, RowMatrix measurement,
                     const Eigen::Ref<const Eigen::MatrixXd>& directions, const std::vector<double>& spread)
    : noise(std::move(channel_noise)), measured(std::move(measurement)) {
  if (static_cast<Eigen::Index>(noise.size()) != measured.rows())
    throw ParameterError(sentence("noise of ", noise.size(), " channels: expected ", measured.rows(), ", as measured"));
  for (std::size_t c = 0; c < noise.size(); ++c)
    for (const double a : noise[c].ar)
      if (!std::isfinite(a)) throw ParameterError(sentence("ar[", c, "] = ", a, ": expected finite coefficients"));
  find_runs();
  find_effect(directions, spread);
}

bool Whitening::scores(std::size_t channel) const {
  return noise[channel].sd > 0 && std::isfinite(noise[channel].sd);
}

void Whitening::find_runs() {
  for (std::size_t c = 0; c < noise.size(); ++c) {
    if (!scores(c)) continue;
    const auto row = static_cast<Eigen::Index>(c);
    const auto order = static_cast<Eigen::Index>(noise[c].ar.size());
    Eigen::Index unbroken = 0;
    const std::size_t runs_before = runs.size();
    for (Eigen::Index t = 0; t < measured.cols(); ++t) {
      unbroken = std::isfinite(measured(row, t)) ? unbroken + 1 : 0;
      if (unbroken <= order) continue;
      if (unbroken == order + 1) runs.push_back({c, t, 0});
      ++runs.back().length;
      ++num_rows;
    }
    if (runs.size() == runs_before)
      throw ParameterError(sentence("channel ", c, ": no ", order + 1,
                                    " samples in a row were measured; expected some, or sd[", c,
                                    "] = inf to leave it out"));
  }
  if (num_rows == 0) throw ParameterError("sd: no channel has a finite positive one; expected something to score");
}

void Whitening::find_effect(const Eigen::Ref<const Eigen::MatrixXd>& directions, const std::vector<double>& spread) {
  const auto k = static_cast<Eigen::Index>(spread.size());
  if (directions.cols() != k || (k > 0 && directions.rows() != num_rows))
    throw ParameterError(sentence("directions of shape (", directions.rows(), ", ", directions.cols(), "): expected (",
                                  num_rows, ", ", k, "), a column for each spread"));
  for (const double tau : spread) require_within("spread", tau, 0.0, std::numeric_limits<double>::max());
  if (k == 0) return;
  effect = RandomEffect(directions * Eigen::Map<const Eigen::VectorXd>(spread.data(), k).asDiagonal());
}

Cells Whitening::cells() const {
  Cells of(2, num_rows);
  Eigen::Index row = 0;
  for (const Run& run : runs)
    for (Eigen::Index k = 0; k < run.length; ++k, ++row) {
      of(0, row) = static_cast<int>(run.channel);
      of(1, row) = static_cast<int>(run.first + k);
    }
  return of;
}

void Whitening::filter(const Eigen::Ref<const RowMatrix>& signals, Eigen::Ref<Eigen::VectorXd> out,
                       double factor) const {
  double* row = out.data();
  for (const Run& run : runs) {
    const ChannelNoise& of = noise[run.channel];
    const double* signal = signals.row(static_cast<Eigen::Index>(run.channel)).data() + run.first;
    const auto length = static_cast<std::size_t>(run.length);
    filter_column(signal, length, of.ar.data(), of.ar.size(), factor / of.sd, row);
    row += length;
  }
}

void Whitening::shrink(Eigen::Ref<Eigen::MatrixXd> columns) const {
  effect.whiten(columns);
}

Eigen::VectorXd Whitening::apply(const Eigen::Ref<const RowMatrix>& signals) const {
  if (signals.rows() != channels() || signals.cols() != samples())
    throw ParameterError(sentence("signals of shape (", signals.rows(), ", ", signals.cols(), "): expected (",
                                  channels(), ", ", samples(), ")"));
  Eigen::VectorXd out(num_rows);
  filter(signals, out);
  shrink(out);
  return out;
}

Eigen::VectorXd Whitening::residual(const Eigen::Ref<const RowMatrix>& signals) const {
  if (signals.rows() != channels() || signals.cols() != samples()) return apply(signals);  // says what is wrong
  return apply(RowMatrix(signals - measured));
}
}  // namespace tendonlab::identify
