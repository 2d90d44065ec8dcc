// SPDX-License-Identifier: BSD-3-Clause
// Derivatives by finite differences, for checks of those by formula.
#pragma once

#include <type_traits>

namespace palpate::test {

/// f'(0) from central differences with the steps h, h/2, h/4 and Richardson's extrapolation: the
/// error is O(h⁶) and that of rounding about 20 ε |f| / h. f returns a number or a matrix.
template <class F>
auto derivative(const F& f, double h) {
  using Value = std::decay_t<decltype(f(h))>;
  const auto difference = [&](double step) {
    Value d = (f(step) - f(-step)) / (2 * step);
    return d;
  };
  const Value d1 = difference(h);
  const Value d2 = difference(h / 2);
  const Value d4 = difference(h / 4);
  const Value d12 = (4 * d2 - d1) / 3;
  const Value d24 = (4 * d4 - d2) / 3;
  Value result = (16 * d24 - d12) / 15;
  return result;
}

}  // namespace palpate::test
