// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/packed_basis.h"

#include <zlib.h>

#include <cmath>
#include <cstring>
#include <new>

namespace palpate {
namespace {

constexpr std::size_t kBytesOfNumber = 4;
/// No content is deflated to less than this share of it.
constexpr std::size_t kMostInflated = 1032;

std::uint32_t bits_of(float number, float step) {
  if (step == 0) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    return bits;
  }
  const auto n = static_cast<std::int32_t>(std::lround(number / step));
  return static_cast<std::uint32_t>(n < 0 ? -2 * n - 1 : 2 * n);
}

float number_of(std::uint32_t bits, float step) {
  if (step == 0) {
    float number = 0;
    std::memcpy(&number, &bits, sizeof number);
    return number;
  }
  const auto half = static_cast<std::int32_t>(bits / 2);
  return step * static_cast<float>(bits % 2 == 0 ? half : -half - 1);
}

/// Calls visit(i, number, step) for each number of all modes, with its place among them.
template <class Basis, class Visit>
void for_each_number(Basis& basis, Visit&& visit) {
  std::size_t i = 0;
  Eigen::Index step = 0;
  for (auto* modes : {&basis.modes, &basis.pressure_modes}) {
    for (Eigen::Index m = 0; m < modes->cols(); ++m, ++step) {
      for (Eigen::Index r = 0; r < modes->rows(); ++r) {
        visit(i++, (*modes)(r, m), basis.steps[step]);
      }
    }
  }
}

std::size_t count_of(const FieldBasis& basis) {
  return static_cast<std::size_t>(basis.modes.size() + basis.pressure_modes.size());
}

}  // namespace

PackedBasis pack(const FieldBasis& basis) {
  PackedBasis packed;
  static_cast<BasisHead&>(packed) = basis;
  packed.num_modes = basis.modes.cols();
  packed.num_pressure_modes = basis.pressure_modes.cols();
  packed.num_pressures = basis.pressure_modes.rows();
  packed.steps = basis.steps;
  const std::size_t count = count_of(basis);
  std::vector<Bytef> planes(kBytesOfNumber * count);
  for_each_number(basis, [&](std::size_t i, float number, float step) {
    const std::uint32_t bits = bits_of(number, step);
    for (std::size_t b = 0; b < kBytesOfNumber; ++b) {
      planes[b * count + i] = static_cast<Bytef>(bits >> (8 * b));
    }
  });
  uLongf size = compressBound(static_cast<uLong>(planes.size()));
  packed.numbers.resize(size);
  const int outcome = compress(reinterpret_cast<Bytef*>(packed.numbers.data()), &size,
                               planes.data(), static_cast<uLong>(planes.size()));
  if (outcome != Z_OK) throw std::bad_alloc();
  packed.numbers.resize(size);
  packed.numbers.shrink_to_fit();
  return packed;
}

std::int64_t most_bytes(const PackedBasis& head, std::int64_t num_points) {
  const std::int64_t count =
      3 * num_points * head.num_modes + head.num_pressures * head.num_pressure_modes;
  const auto of_numbers = static_cast<uLong>(count) * kBytesOfNumber;
  const auto of_steps = (head.num_modes + head.num_pressure_modes) * std::int64_t{sizeof(float)};
  return static_cast<std::int64_t>(compressBound(of_numbers)) + of_steps;
}

std::optional<FieldBasis> unpack(const PackedBasis& packed, std::int64_t num_points) {
  const auto count = static_cast<std::size_t>(3 * num_points * packed.num_modes +
                                              packed.num_pressures * packed.num_pressure_modes);
  const std::size_t bytes = kBytesOfNumber * count;
  if (packed.steps.size() != packed.num_modes + packed.num_pressure_modes) return std::nullopt;
  if (bytes / kMostInflated > packed.numbers.size()) return std::nullopt;
  // One more, so that there is an address where there is no mode.
  std::vector<Bytef> planes(bytes + 1);
  uLongf size = static_cast<uLongf>(planes.size());
  const int outcome =
      uncompress(planes.data(), &size, reinterpret_cast<const Bytef*>(packed.numbers.data()),
                 static_cast<uLong>(packed.numbers.size()));
  if (outcome == Z_MEM_ERROR) throw std::bad_alloc();
  if (outcome != Z_OK || size != bytes) return std::nullopt;
  FieldBasis basis;
  static_cast<BasisHead&>(basis) = packed;
  basis.steps = packed.steps;
  basis.modes.resize(3 * num_points, packed.num_modes);
  basis.pressure_modes.resize(packed.num_pressures, packed.num_pressure_modes);
  bool finite = basis.steps.allFinite();
  for_each_number(basis, [&](std::size_t i, float& number, float step) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < kBytesOfNumber; ++b) {
      bits |= std::uint32_t{planes[b * count + i]} << (8 * b);
    }
    number = number_of(bits, step);
    finite = finite && std::isfinite(number);
  });
  if (!finite) return std::nullopt;
  return basis;
}

}  // namespace palpate
