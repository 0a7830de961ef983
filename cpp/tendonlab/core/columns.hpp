#pragma once
// Loops along columns of thousands of numbers, compiled for the processor as the systems are.
#include <cstddef>

namespace tendonlab {
/// All products A'A of the columns of A, (columns, columns). A: (rows, columns), column after column.
void multiply_columns(const double* a, std::size_t rows, std::size_t columns, double* products);

/// out[t] = factor (signal[t] - sum_k ar[k] signal[t-1-k]) for `length` samples; `order` of them lie before `signal`.
void filter_column(const double* signal, std::size_t length, const double* ar, std::size_t order, double factor,
                   double* out);
}  // namespace tendonlab
