#pragma once
// From residuals in units of their signals to independent ones of unit variance: one matrix per experiment, never
// formed.
#include <limits>
#include <vector>

#include "tendonlab/identify/random_effect.hpp"

namespace tendonlab::identify {
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Cells = Eigen::Matrix<int, 2, Eigen::Dynamic, Eigen::RowMajor>;

/// Noise of one output: e_t = (r_t - sum_k ar[k] r_{t-1-k}) / sd is white with unit variance.
struct ChannelNoise {
  std::vector<double> ar;
  double sd =
      std::numeric_limits<double>::infinity();  ///< of the innovation, in the signal's unit; infinite: not scored
};

/// W = (I + V diag(tau^2) V')^(-1/2) A: A filters each channel by its noise; V are directions, already filtered, along
/// which whole experiments differ from run to run, tau their spread.
/// Rows: channel by channel, time increasing; a sample counts where it and the samples its filter needs were measured,
/// so that the first ones of a channel, and those after a gap, only start the filter.
class Whitening {
 public:
  /// `measured`: (channels, samples), NaN where nothing was measured. `directions`: (rows, k). Throws ParameterError.
  Whitening(std::vector<ChannelNoise> noise, RowMatrix measured, const Eigen::Ref<const Eigen::MatrixXd>& directions,
            const std::vector<double>& spread);

  Eigen::Index rows() const { return num_rows; }
  Eigen::Index channels() const { return measured.rows(); }
  Eigen::Index samples() const { return measured.cols(); }
  bool scores(std::size_t channel) const;
  /// Channel (first) and sample (second) of each row.
  Cells cells() const;
  /// Whitened `signals`, (channels, samples) -> (rows).
  Eigen::VectorXd apply(const Eigen::Ref<const RowMatrix>& signals) const;
  /// Whitened differences of `signals` from what was measured.
  Eigen::VectorXd residual(const Eigen::Ref<const RowMatrix>& signals) const;
  /// The filter alone: factor A signals.
  void filter(const Eigen::Ref<const RowMatrix>& signals, Eigen::Ref<Eigen::VectorXd> out, double factor = 1.0) const;
  /// What follows the filter, on each column of (rows, m).
  void shrink(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  struct Run {  ///< samples [first, first + length) of a channel that count, one after the other
    std::size_t channel;
    Eigen::Index first, length;
  };
  void find_runs();
  void find_effect(const Eigen::Ref<const Eigen::MatrixXd>& directions, const std::vector<double>& spread);

  std::vector<ChannelNoise> noise;
  RowMatrix measured;
  std::vector<Run> runs;
  Eigen::Index num_rows = 0;
  RandomEffect effect;
};
}  // namespace tendonlab::identify
