// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transfer.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace palpate {

void Packer::put(const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), first, first + size);
}

template <class Matrix>
void Packer::put_matrix(const Matrix& matrix) {
  put(std::array<std::int64_t, 2>{matrix.rows(), matrix.cols()});
  put(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(typename Matrix::Scalar));
}

void Packer::put(const ConfigurationSummary& summary) { put(&summary, sizeof summary); }

void Packer::put(const Configuration& configuration) {
  put(static_cast<const ConfigurationSummary&>(configuration));
  for_each_field(configuration, [&](const auto& field) { put_matrix(field); });
}

void Packer::put(const IntermediateState& state) { put(&state, sizeof state); }

void Packer::put(const TestPoint& point) {
  for_each_number_of_test_point(point, [&](const auto& number) { put(number); });
  put_matrix(point.displacement);
}

void Unpacker::take(void* data, std::size_t size) {
  if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

template <class Matrix>
void Unpacker::take_matrix(Matrix& matrix) {
  const auto shape = take<std::array<std::int64_t, 2>>();
  matrix.resize(shape[0], shape[1]);
  take(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(typename Matrix::Scalar));
}

void Unpacker::take(ConfigurationSummary& summary) {
  take(static_cast<void*>(&summary), sizeof summary);
}

void Unpacker::take(Configuration& configuration) {
  take(static_cast<ConfigurationSummary&>(configuration));
  for_each_field(configuration, [&](auto& field) { take_matrix(field); });
}

void Unpacker::take(IntermediateState& state) { take(static_cast<void*>(&state), sizeof state); }

void Unpacker::take(TestPoint& point) {
  for_each_number_of_test_point(point, [&](auto& number) { take(number); });
  take_matrix(point.displacement);
}

}  // namespace palpate
