// SPDX-License-Identifier: BSD-3-Clause
#include "fields/packed_basis.h"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <new>

namespace palpate {
namespace {

constexpr std::size_t kBytesOfNumber = 4;
/// Deflating makes no content smaller than by this factor.
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

/// The bytes that a basis was deflated from, one after the other.
class Inflation {
 public:
  explicit Inflation(const std::vector<std::byte>& deflated) {
    // zlib's type is not constant, but it does not write there.
    stream_.next_in =
        const_cast<Bytef*>(reinterpret_cast<const Bytef*>(deflated.data()));  // NOLINT
    stream_.avail_in = static_cast<uInt>(deflated.size());
    if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
  }
  ~Inflation() { inflateEnd(&stream_); }
  Inflation(const Inflation&) = delete;
  Inflation& operator=(const Inflation&) = delete;

  /// The next byte; zero after the last one, and where the content is damaged.
  [[nodiscard]] Bytef next() {
    if (at_ == size_ && !fill()) {
      is_short_ = true;
      return 0;
    }
    return buffer_[at_++];
  }

  /// Whether the last byte was read, none was missing, and their checksum is right.
  [[nodiscard]] bool is_at_end() {
    return !is_short_ && at_ == size_ && !fill() && status_ == Z_STREAM_END;
  }

 private:
  bool fill() {
    if (status_ != Z_OK) return false;
    stream_.next_out = buffer_.data();
    stream_.avail_out = static_cast<uInt>(buffer_.size());
    status_ = inflate(&stream_, Z_NO_FLUSH);
    if (status_ == Z_MEM_ERROR) throw std::bad_alloc();
    at_ = 0;
    size_ = buffer_.size() - stream_.avail_out;
    return size_ > 0;
  }

  z_stream stream_{};
  std::array<Bytef, 1 << 16> buffer_;
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  int status_ = Z_OK;
  bool is_short_ = false;
};

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
  if (packed.steps.size() != packed.num_modes + packed.num_pressure_modes) return std::nullopt;
  if (kBytesOfNumber * count / kMostInflated > packed.numbers.size()) return std::nullopt;
  FieldBasis basis;
  static_cast<BasisHead&>(basis) = packed;
  basis.steps = packed.steps;
  basis.modes.setZero(3 * num_points, packed.num_modes);
  basis.pressure_modes.setZero(packed.num_pressures, packed.num_pressure_modes);
  // The bits of each number are gathered where it will be: no other memory is taken for them.
  Inflation numbers(packed.numbers);
  for (std::size_t b = 0; b < kBytesOfNumber; ++b) {
    for_each_number(basis, [&](std::size_t, float& number, float) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &number, sizeof bits);
      bits |= std::uint32_t{numbers.next()} << (8 * b);
      std::memcpy(&number, &bits, sizeof bits);
    });
  }
  if (!numbers.is_at_end()) return std::nullopt;
  bool finite = basis.steps.allFinite();
  for_each_number(basis, [&](std::size_t, float& number, float step) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    number = number_of(bits, step);
    finite = finite && std::isfinite(number);
  });
  if (!finite) return std::nullopt;
  return basis;
}

}  // namespace palpate
