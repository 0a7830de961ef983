#include "tendonlab/core/columns.hpp"

#include <algorithm>

#include "tendonlab/core/lanes.hpp"

namespace tendonlab {
namespace {
constexpr std::size_t lanes = Lanes::count, stretch = 512;  // rows at a time: so many of all columns fit into the cache
constexpr int high = 2, wide = 4;                           // products at a time: so many sums fit into registers

/// Products of `high` columns with `wide` others over `rows` rows, added to `sum`.
void add_products(const double* const (&left)[high], const double* const (&right)[wide], std::size_t rows,
                  double (&sum)[high][wide]) {
  Lanes all[high][wide];
  std::size_t t = 0;
  for (; t + lanes <= rows; t += lanes)
    for (int i = 0; i < high; ++i) {
      const Lanes l(left[i] + t);
      for (int j = 0; j < wide; ++j) all[i][j] = all[i][j] + l * Lanes(right[j] + t);
    }
  for (int i = 0; i < high; ++i)
    for (int j = 0; j < wide; ++j) {
      for (int l = 0; l < Lanes::count; ++l) sum[i][j] += all[i][j][l];
      for (std::size_t k = t; k < rows; ++k) sum[i][j] += left[i][k] * right[j][k];
    }
}
}  // namespace

void multiply_columns(const double* a, std::size_t rows, std::size_t columns, double* products) {
  std::fill_n(products, columns * columns, 0.0);
  for (std::size_t from = 0; from < rows; from += stretch)
    for (std::size_t i = 0; i < columns; i += high)
      for (std::size_t j = 0; j < std::min(i + high, columns); j += wide) {
        const auto column = [&](std::size_t c) { return a + std::min(c, columns - 1) * rows + from; };
        const double* const left[high] = {column(i), column(i + 1)};
        const double* const right[wide] = {column(j), column(j + 1), column(j + 2), column(j + 3)};
        double sum[high][wide] = {};
        add_products(left, right, std::min(stretch, rows - from), sum);
        for (std::size_t k = 0; k < high && i + k < columns; ++k)
          for (std::size_t l = 0; l < wide && j + l <= i + k; ++l) products[(j + l) * columns + i + k] += sum[k][l];
      }
  for (std::size_t i = 0; i < columns; ++i)
    for (std::size_t j = 0; j < i; ++j) products[i * columns + j] = products[j * columns + i];
}

void filter_column(const double* signal, std::size_t length, const double* ar, std::size_t order, double factor,
                   double* out) {
  std::size_t t = 0;
  for (; t + lanes <= length; t += lanes) {
    Lanes sum(signal + t);
    for (std::size_t k = 0; k < order; ++k) sum = sum - ar[k] * Lanes(signal + t - k - 1);
    Lanes(factor * sum).store(out + t);
  }
  for (; t < length; ++t) {
    double sum = signal[t];
    for (std::size_t k = 0; k < order; ++k) sum -= ar[k] * signal[t - k - 1];
    out[t] = factor * sum;
  }
}
}  // namespace tendonlab
