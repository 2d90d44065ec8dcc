// SPDX-License-Identifier: BSD-3-Clause
// What benchmarks of growth share: seconds, memory, and a Markdown table with exponents.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace palpate::benchmarks {

inline constexpr double kMilli = 1e-3;
inline constexpr double kMega = 1e6;

inline double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of this process alone, whatever else the machine does.
inline double processor_seconds(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Of the quickest of some runs.
inline double least_seconds(const std::function<void()>& work) {
  double least = seconds(work);
  for (int i = 0; i < 4; ++i) least = std::min(least, seconds(work));
  return least;
}

/// The largest size of this rank begins anew.
inline void forget_peak() { std::ofstream("/proc/self/clear_refs") << '5'; }

/// Largest size of this rank since then.
inline double peak_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

struct Figure {
  const char* name;
  double unit;  // of the table, in SI
  double value;
};

inline void print_header(const std::vector<Figure>& figures) {
  std::string line = "|";
  for (std::size_t i = 0; i < figures.size(); ++i) line += "---|";
  for (const Figure& figure : figures) std::printf("| %s ", figure.name);
  std::printf("|\n%s\n", line.c_str());
}

/// Slope of the logarithms over the first column, by least squares; rows without a value, which is
/// NaN, are left out.
inline double exponent(const std::vector<std::vector<Figure>>& rows, std::size_t column) {
  double x = 0, y = 0, xx = 0, xy = 0, n = 0;
  for (const auto& row : rows) {
    const double u = std::log(row.front().value);
    const double v = std::log(row[column].value);
    if (std::isnan(v)) continue;
    x += u, y += v, xx += u * u, xy += u * v, n += 1;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// Prints the row that was added last, with the header before the first.
inline void print_row(const std::vector<std::vector<Figure>>& rows) {
  if (rows.size() == 1) print_header(rows.front());
  for (const Figure& figure : rows.back()) std::printf("| %.4g ", figure.value / figure.unit);
  std::printf("|\n");
  std::fflush(stdout);
}

inline void print_exponents(const std::vector<std::vector<Figure>>& rows) {
  if (rows.size() < 2) return;
  for (std::size_t column = 0; column < rows.front().size(); ++column) {
    std::printf("| **%.2f** ", exponent(rows, column));
  }
  std::printf("|\n");
}

}  // namespace palpate::benchmarks
