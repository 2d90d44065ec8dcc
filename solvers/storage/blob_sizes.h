// SPDX-License-Identifier: BSD-3-Clause
// The length of each BLOB of schema.sql.h, as the key figures of the body and of its row tell it.
//
// A file may be damaged, or made by anyone: nothing is copied out of a BLOB before its length was
// compared with what is said here, and no memory is taken for a length that is merely claimed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <vector>

#include "fields/packed_basis.h"
#include "state_space/test_point.h"
#include "storage/sqlite.h"

namespace palpate::blobs {

/// How many numbers a BLOB holds.
template <class Number>
struct Size {
  std::int64_t least = 0;
  std::int64_t most = 0;
  /// The BLOB may be NULL instead, which holds no numbers.
  bool or_none = false;
  /// The BLOB holds complete groups of so many numbers: the components of a point, or the corners
  /// of a triangle.
  std::int64_t group = 1;

  [[nodiscard]] bool fits(std::size_t bytes) const {
    if (bytes == 0 && or_none) return true;
    const auto count = static_cast<std::int64_t>(bytes / sizeof(Number));
    return bytes % sizeof(Number) == 0 && count >= least && count <= most && count % group == 0;
  }
};

template <class Number>
[[nodiscard]] constexpr Size<Number> exactly(std::int64_t count) {
  return {count, count};
}
template <class Number>
[[nodiscard]] constexpr Size<Number> none_or(std::int64_t count) {
  return {count, count, true};
}
template <class Number>
[[nodiscard]] constexpr Size<Number> up_to(std::int64_t count, std::int64_t group = 1) {
  return {0, count, false, group};
}

/// The largest row that SQLite stores, bytes.
inline constexpr std::int64_t kLargestRow = 1'000'000'000;
/// The largest size of the plain numbers of a row, bytes.
inline constexpr std::int64_t kOfNumbers = 1 << 16;

// Table scene.
[[nodiscard]] inline Size<double> points(std::int64_t num_points) {
  return exactly<double>(3 * num_points);
}
[[nodiscard]] inline Size<Index> cells(std::int64_t num_cells, int nodes_per_cell) {
  return exactly<Index>(num_cells * nodes_per_cell);
}
/// The column material_of_cell, and part_of_cell of table body_contact.
[[nodiscard]] inline Size<Index> of_cells(std::int64_t num_cells) {
  return none_or<Index>(num_cells);
}
/// The column faces of table body_cut, in numbers.
[[nodiscard]] inline Size<OpenedFaces> faces_of_cells(std::int64_t num_cells) {
  return exactly<OpenedFaces>(num_cells);
}
/// The column areas of table body_cut.
[[nodiscard]] inline Size<double> areas_of_stages() {
  return up_to<double>(kOfNumbers / std::int64_t{sizeof(double)});
}
/// The columns fixed and touchable.
[[nodiscard]] inline Size<char> marks(std::int64_t num_points) { return exactly<char>(num_points); }

// Table tool_space.
/// The columns material_point, tool_axis and origin.
[[nodiscard]] inline Size<double> vector() { return exactly<double>(3); }
/// The column numbers of table tool_motion.
[[nodiscard]] inline Size<double> motion_numbers() {
  return up_to<double>(kOfNumbers / std::int64_t{sizeof(double)});
}
[[nodiscard]] inline Size<double> tool_points() {
  return up_to<double>(kLargestRow / std::int64_t{sizeof(double)}, 3);
}
[[nodiscard]] inline Size<Index> tool_triangles() {
  return up_to<Index>(kLargestRow / std::int64_t{sizeof(Index)}, 3);
}

// Table configuration. A field that is whole has numbers of either precision; the derivatives v and
// p_v have three times as many numbers as u and p.
[[nodiscard]] inline Size<double> third_derivative() { return none_or<double>(10); }
/// The column derivatives of table turn_derivative: of five or six coordinates.
[[nodiscard]] inline Size<double> turn_derivatives() { return up_to<double>(83); }
template <class Number>
[[nodiscard]] Size<Number> displacement(std::int64_t num_points) {
  return none_or<Number>(3 * num_points);
}
template <class Number>
[[nodiscard]] Size<Number> pressures(std::int64_t num_pressures) {
  return none_or<Number>(num_pressures);
}
/// The coefficients of a field that is reduced to modes.
[[nodiscard]] inline Size<float> coefficients(std::int64_t num_modes) {
  return up_to<float>(num_modes);
}

// Table basis. The numbers of the head must be possible, see rows::is_possible().
[[nodiscard]] inline Size<float> steps(const PackedBasis& head) {
  return exactly<float>(head.num_modes + head.num_pressure_modes);
}
/// @param num_kept The points that the basis is for.
[[nodiscard]] inline Size<std::byte> modes(const PackedBasis& head, std::int64_t num_kept) {
  return up_to<std::byte>(most_bytes(head, num_kept));
}

// Table test_point.
[[nodiscard]] inline Size<float> sampled_displacement() {
  return up_to<float>(std::int64_t{kSamplePoints} * 3, 3);
}

// Table body_force.
[[nodiscard]] inline Size<double> densities(std::int64_t num_materials) {
  return exactly<double>(num_materials);
}
[[nodiscard]] inline Size<double> settled_displacement(std::int64_t num_points) {
  return exactly<double>(3 * num_points);
}

// Table boundary_array. The body at rest has settled_displacement() and pressures().
/// @param components The number of components of each point.
[[nodiscard]] inline Size<double> boundary_array(std::int64_t num_points, std::int64_t components) {
  return exactly<double>(num_points * components);
}

// Table reduced_array.
/// @param num_rows, num_columns Neither is below zero, and their product is no more than kMost².
[[nodiscard]] inline Size<double> array(std::int64_t num_rows, std::int64_t num_columns) {
  return exactly<double>(num_rows * num_columns);
}

/// Copies a BLOB of the right length. @returns False: it has another, and nothing was copied.
template <class Number, class T>
[[nodiscard]] bool copy(const sqlite::Statement::Blob& blob, const Size<Number>& size,
                        std::vector<T>& to) {
  static_assert(sizeof(T) % sizeof(Number) == 0, "what it holds is made of such numbers");
  if (!size.fits(blob.bytes) || blob.bytes % sizeof(T) != 0) return false;
  to.resize(blob.bytes / sizeof(T));
  if (blob.bytes > 0) std::memcpy(static_cast<void*>(to.data()), blob.data, blob.bytes);
  return true;
}
/// @param to A vector, or a matrix of the size that the BLOB is to have.
template <class Number, int rows, int columns>
[[nodiscard]] bool copy(const sqlite::Statement::Blob& blob, const Size<Number>& size,
                        Eigen::Matrix<Number, rows, columns>& to) {
  if (!size.fits(blob.bytes)) return false;
  const auto count = static_cast<Eigen::Index>(blob.bytes / sizeof(Number));
  if constexpr (rows == Eigen::Dynamic && columns == 1) to.resize(count);
  if (to.size() != count) return false;
  if (blob.bytes > 0) std::memcpy(static_cast<void*>(to.data()), blob.data, blob.bytes);
  return true;
}

}  // namespace palpate::blobs
