// SPDX-License-Identifier: BSD-3-Clause
#include "storage/rows.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <type_traits>

#include "base/printable.h"
#include "storage/stored_kind.h"

namespace palpate::rows {
namespace {

/// Gathers the numbers that a checksum takes in, 8 bytes each.
struct Gather {
  std::vector<std::int64_t>& bits;
  void operator()(double x) const {
    std::int64_t of_x = -1;  // any NaN: the file has only one
    if (!std::isnan(x)) std::memcpy(&of_x, &x, sizeof of_x);
    bits.push_back(of_x);
  }
  template <class Integer>
  void operator()(Integer x) const {
    bits.push_back(static_cast<std::int64_t>(x));
  }
  void operator()(const Vec3& x) const {
    for (const double component : x) (*this)(component);
  }
  template <class T>
  void operator()(const std::vector<T>& x) const {
    bits.push_back(static_cast<std::int64_t>(x.size()));
    bits.push_back(static_cast<std::int64_t>(XXH3_64bits(x.data(), x.size() * sizeof(T))));
  }
  void operator()(const ThirdDerivative& x) const {
    if (!x.allFinite()) return;
    for (const double component : x) (*this)(component);
  }
};

std::int64_t checksum_of(const std::vector<std::int64_t>& bits) {
  return static_cast<std::int64_t>(XXH3_64bits(bits.data(), bits.size() * sizeof bits[0]));
}

std::int64_t checksum_of(const void* data, std::size_t bytes, std::int64_t seed) {
  return static_cast<std::int64_t>(
      XXH3_64bits_withSeed(data, bytes, static_cast<XXH64_hash_t>(seed)));
}

/// The bits that a checksum of numbers begins with.
std::vector<std::int64_t> bits_of(BodyId body) {
  if (body == kFirstBody) return {};
  return {body};
}
std::vector<std::int64_t> bits_of(const ToolSpaceKey& key) {
  std::vector<std::int64_t> bits = bits_of(key.body);
  bits.push_back(key.id);
  return bits;
}

/// The value that a checksum of bytes begins with.
std::int64_t seed_of(BodyId body) { return body == kFirstBody ? 0 : checksum_of(bits_of(body)); }

/// The numbers of a vector or matrix as they lie in memory.
template <class Numbers>
sqlite::Statement::Blob blob_of(const Numbers& numbers) {
  const auto size = static_cast<std::size_t>(numbers.size());
  return {size == 0 ? nullptr : numbers.data(), size * sizeof(typename Numbers::Scalar)};
}

template <class OfConfiguration>
Fields blobs_of(const OfConfiguration& fields) {
  Fields result;
  auto next = result.begin();
  for_each_field(fields, [&](const auto& field) { *next++ = blob_of(field); });
  return result;
}

/// How far a configuration may lie from its check-point, in spacings, for rounding.
constexpr double kOffCheckPoint = 1e-4;

bool is_possible(Outcome outcome) {
  return outcome >= Outcome::converged && outcome <= Outcome::tool_inside;
}

bool is_possible(Flags of_solve) { return (of_solve & ~flags::all) == 0; }

bool is_in_box(const Grid& grid, const CheckPoint& c) {
  return std::all_of(c.begin(), c.end(),
                     [&](std::int32_t x) { return x >= -grid.reach() && x <= grid.reach(); });
}

/// The size of one number of the fields, which follows from that of the displacements of so many
/// points, bytes.
std::size_t bytes_of_number(const Fields& fields, std::int64_t num_points) {
  const bool is_single =
      num_points > 0 && fields[0].bytes == static_cast<std::size_t>(num_points) * 3 * sizeof(float);
  return is_single ? sizeof(float) : sizeof(double);
}

template <class Number, class Field>
void unpack(const void* data, std::size_t bytes, Field& field) {
  field = Field();
  if (bytes == 0) return;
  constexpr Eigen::Index columns = Field::ColsAtCompileTime == 1 ? 1 : 3;
  Eigen::Matrix<Number, Eigen::Dynamic, Field::ColsAtCompileTime> numbers(
      static_cast<Eigen::Index>(bytes / sizeof(Number)) / columns, columns);
  std::memcpy(numbers.data(), data, bytes);
  field = numbers.template cast<double>();
}

}  // namespace

Fields fields_of(const Configuration& configuration) { return blobs_of(configuration); }

SingleFields single_fields_of(const Configuration& configuration) {
  SingleFields fields;
  auto next = fields.begin();
  for_each_field(configuration, [&](const auto& field) { *next++ = field.template cast<float>(); });
  return fields;
}

Fields fields_of(const SingleFields& fields) {
  Fields result;
  std::transform(fields.begin(), fields.end(), result.begin(),
                 [](const Eigen::MatrixXf& field) { return blob_of(field); });
  return result;
}

void set_fields(const Fields& fields, std::int64_t num_points, Configuration& configuration) {
  const bool is_single = bytes_of_number(fields, num_points) == sizeof(float);
  auto next = fields.begin();
  for_each_field(configuration, [&](auto& field) {
    const auto [data, bytes] = *next++;
    if (is_single) {
      unpack<float>(data, bytes, field);
    } else {
      unpack<double>(data, bytes, field);
    }
  });
}

Fields fields_of(const ReducedFields& reduced) { return blobs_of(reduced); }

ReducedFields reduced_of(const Fields& fields) {
  const auto vector = [](const sqlite::Statement::Blob& blob, Eigen::Index columns) {
    Eigen::MatrixXf numbers(static_cast<Eigen::Index>(blob.bytes / sizeof(float)) / columns,
                            columns);
    if (blob.bytes > 0) std::memcpy(numbers.data(), blob.data, blob.bytes);
    return numbers;
  };
  return {vector(fields[0], 1), vector(fields[1], 3), vector(fields[2], 1), vector(fields[3], 3)};
}

std::array<sqlite::Statement::Blob, 2> modes_of(const PackedBasis& basis) {
  return {sqlite::Statement::Blob{basis.steps.data(),
                                  static_cast<std::size_t>(basis.steps.size()) * sizeof(float)},
          sqlite::Statement::Blob{basis.numbers.data(), basis.numbers.size()}};
}

bool set_modes(const std::array<sqlite::Statement::Blob, 2>& modes, std::int64_t num_kept,
               PackedBasis& basis) {
  const auto& [steps, numbers] = modes;
  return blobs::copy(steps, blobs::steps(basis), basis.steps) &&
         blobs::copy(numbers, blobs::modes(basis, num_kept), basis.numbers);
}

std::int64_t checksum(const std::array<sqlite::Statement::Blob, 2>& modes) {
  const auto& [steps, numbers] = modes;
  return checksum_of(numbers.data, numbers.bytes, checksum_of(steps.data, steps.bytes, 0));
}

std::int64_t checksum(const ToolSpaceKey& key, const BasisRow& row, Checked checked) {
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_basis(row, Gather{bits}, checked);
  return checksum_of(bits);
}

std::int64_t checksum(const ToolSpaceKey& key, const ModeKey& mode, sqlite::Statement::Blob field) {
  std::vector<std::int64_t> bits = bits_of(key);
  bits.insert(bits.end(), {mode.basis, mode.of_pressure, mode.number});
  return checksum_of(field.data, field.bytes, checksum_of(bits));
}

std::int64_t checksum(const Fields& fields) {
  std::int64_t sum = 0;
  for (const auto& [data, bytes] : fields) sum = checksum_of(data, bytes, sum);
  return sum;
}

std::int64_t checksum(const ToolSpace& space, Checked checked) {
  std::vector<std::int64_t> bits = bits_of(space.setup.body);
  for_each_number_of_tool_space(space, Gather{bits}, checked);
  // A tool without an offset was stored by a version that had none.
  const RigidTool& tool = space.setup.interaction.tool;
  if (tool.law.offset != 0) Gather{bits}(tool.law.offset);
  if (tool.motion != ToolMotion::translated) {
    bits.push_back(static_cast<std::int64_t>(tool.motion));
    for (const double number : tool.motion_numbers) Gather{bits}(number);
  }
  if (space.setup.region) for_each_number_of_mesh_region(*space.setup.region, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(const ToolSpaceKey& key, ConfigurationSummary summary, std::int64_t of_fields,
                      Checked checked) {
  if (checked == Checked::as_version_5) summary.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_summary(summary, Gather{bits});
  if (checked != Checked::as_version_5) bits.push_back(of_fields);
  return checksum_of(bits);
}

std::int64_t checksum_of_mesh_error(const ToolSpaceKey& key, const ConfigurationSummary& summary) {
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_mesh_error_row(summary, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum_of_turns(const ToolSpaceKey& key, const ConfigurationSummary& summary) {
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_turn_row(summary, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(const ToolSpaceKey& key, const LevelTransition& transition) {
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_transition(transition, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(const ToolSpaceKey& key, IntermediateState state, Checked checked) {
  if (checked == Checked::as_version_5) state.flags &= ~flags::beyond_force_limit;
  std::vector<std::int64_t> bits = bits_of(key);
  for_each_number_of_intermediate(state, Gather{bits});
  return checksum_of(bits);
}

std::int64_t checksum(const TestSet& set, const TestPoint& point) {
  std::vector<std::int64_t> bits = bits_of(ToolSpaceKey{set.tool_space, set.body});
  bits.push_back(set.seed);
  Gather{bits}(set.tip_radius);
  Gather{bits}(set.half_width);
  for_each_number_of_test_point(point, Gather{bits});
  return checksum_of(point.displacement.data(),
                     static_cast<std::size_t>(point.displacement.size()) * sizeof(float),
                     checksum_of(bits));
}

std::int64_t checksum(BodyId body, const ReducedArrayRow& row, sqlite::Statement::Blob numbers) {
  std::int64_t sum = checksum_of(row.model.data(), row.model.size(), seed_of(body));
  sum = checksum_of(row.name.data(), row.name.size(), sum);
  const std::array<std::int64_t, 3> sizes = {row.num_arrays, row.num_rows, row.num_columns};
  sum = checksum_of(sizes.data(), sizeof sizes, sum);
  return checksum_of(numbers.data, numbers.bytes, sum);
}

std::int64_t checksum(BodyId body, const std::vector<char>& touchable, double solver_tolerance) {
  std::vector<std::int64_t> bits = bits_of(body);
  Gather{bits}(solver_tolerance);
  return checksum_of(touchable.data(), touchable.size(), checksum_of(bits));
}

std::int64_t checksum(BodyId body, const SettledBody& settled) {
  const auto [u, u_bytes] = blob_of(settled.u);
  const auto [p, p_bytes] = blob_of(settled.p);
  return checksum_of(u, u_bytes, checksum_of(p, p_bytes, seed_of(body)));
}

std::int64_t checksum(BodyId body, std::int64_t stage, sqlite::Statement::Blob areas,
                      sqlite::Statement::Blob faces) {
  std::vector<std::int64_t> bits = bits_of(body);
  Gather{bits}(stage);
  return checksum_of(faces.data, faces.bytes,
                     checksum_of(areas.data, areas.bytes, checksum_of(bits)));
}

std::int64_t checksum(BodyId body, const std::string& name, sqlite::Statement::Blob numbers) {
  return checksum_of(numbers.data, numbers.bytes,
                     checksum_of(name.data(), name.size(), seed_of(body)));
}

bool is_possible(const std::optional<MeshRegion>& region) {
  return !region || (region->centre.allFinite() && is_length(region->band) &&
                     is_length(region->size) && is_length(region->tolerance));
}

bool is_possible(const ToolSpaceSetup& setup, std::int64_t num_points) {
  const Grid& grid = setup.grid;
  const ExplorationPolicy& policy = setup.policy;
  return storage::kind_of(setup).is_possible(setup, num_points) && grid.origin.allFinite() &&
         is_possible(setup.region) && is_length(policy.depth) && is_length(grid.half_width) &&
         is_length(policy.force_limit) && is_length(policy.tolerance) && grid.resolution >= 1 &&
         grid.resolution % 2 == 1 && grid.resolution <= kLargestResolution &&
         (grid.half_width > 0 || grid.resolution == 1) && grid.coarsest >= 1 &&
         (grid.coarsest & (grid.coarsest - 1)) == 0 && grid.reach() % grid.coarsest == 0 &&
         grid.coarsest_resolution() <= kLargestCoarsestResolution &&
         policy.history >= History::flat && policy.history <= History::levels &&
         policy.intermediate_states >= 0 && policy.intermediate_states <= kMostIntermediateStates;
}

bool is_possible(const Grid& grid, const ConfigurationSummary& c) {
  if (!is_in_box(grid, c.check_point) || !is_in_box(grid, c.parent) || c.parent_level < 0 ||
      !is_possible(c.outcome) || !is_possible(c.flags)) {
    return false;
  }
  return !c.usable() ||
         ((c.t - grid.place(c.check_point)).norm() <= kOffCheckPoint * grid.spacing() &&
          std::isfinite(c.energy) && c.force.allFinite() && c.stiffness.allFinite() &&
          c.signature.allFinite());
}

bool is_possible(const Grid& grid, const LevelTransition& transition) {
  return is_in_box(grid, transition.start) && is_in_box(grid, transition.target) &&
         neighbour_number(transition.start, transition.target) >= 0 &&
         transition.start_level >= 0 &&
         (transition.reached >= failed_to_reach || transition.reached == beyond_most_levels);
}

bool is_possible(const Grid& grid, const IntermediateState& state) {
  return is_in_box(grid, state.target) && state.number >= 1 &&
         state.number <= kMostIntermediateStates && is_possible(state.outcome) &&
         is_possible(state.flags) &&
         (!state.usable() ||
          (state.t.allFinite() && std::isfinite(state.energy) && state.force.allFinite()));
}

bool is_possible(const TestPoint& point) {
  return point.kind >= TestKind::uniform && point.kind <= TestKind::near_rest &&
         point.number >= 0 && is_possible(point.outcome) && is_possible(point.flags) &&
         (point.outcome != Outcome::converged ||
          (point.t.allFinite() && std::isfinite(point.energy) && point.force.allFinite() &&
           point.stiffness.allFinite() && point.displacement.allFinite()));
}

bool is_possible(const BasisRow& row, std::int64_t num_kept, std::int64_t num_cells) {
  const PackedBasis& basis = row.basis;
  return (basis.keep == Keep::touch || basis.keep == Keep::surface) && row.number >= 0 &&
         basis.num_modes >= 0 && basis.num_modes < 3 * num_kept && basis.num_pressures >= 0 &&
         basis.num_pressures <= 4 * num_cells && basis.num_pressure_modes >= 0 &&
         basis.num_pressure_modes <= basis.num_pressures && is_length(basis.largest_displacement) &&
         is_length(basis.displacement_error) && is_length(basis.sensitivity_error);
}

bool fit_basis(const Fields& fields, const FieldBasis& basis, std::int64_t num_points) {
  const auto& [u, v, p, p_v] = fields;
  return blobs::coefficients(basis.modes.cols()).fits(u.bytes) && v.bytes == 3 * u.bytes &&
         u.bytes < static_cast<std::size_t>(num_points) * 3 * sizeof(float) &&
         blobs::coefficients(basis.pressure_modes.cols()).fits(p.bytes) && p_v.bytes == 3 * p.bytes;
}

bool fit(const Fields& fields, std::int64_t num_points, std::int64_t num_pressures) {
  const auto& [u, v, p, p_v] = fields;
  const auto have_size = [&](const auto& of_u, const auto& of_p) {
    return of_u.fits(u.bytes) && of_p.fits(p.bytes) && p_v.bytes == 3 * p.bytes;
  };
  const bool fits = bytes_of_number(fields, num_points) == sizeof(float)
                        ? have_size(blobs::displacement<float>(num_points),
                                    blobs::pressures<float>(num_pressures))
                        : have_size(blobs::displacement<double>(num_points),
                                    blobs::pressures<double>(num_pressures));
  // There is no derivative, and no pressure, without a displacement.
  return fits && (v.bytes == 0 || v.bytes == 3 * u.bytes) && (u.bytes > 0 || p.bytes == 0);
}

bool is_possible(const ReducedArrayRow& row, std::int64_t bytes) {
  constexpr std::int64_t kMost = 1 << 30;
  const auto number = static_cast<std::int64_t>(sizeof(double));
  return row.num_rows >= 0 && row.num_columns >= 0 && row.num_rows <= kMost &&
         row.num_columns <= kMost && row.num_rows * row.num_columns == bytes / number &&
         bytes % number == 0;
}

std::string describe(const LevelTransition& transition, const std::string& tool_space) {
  return "transition from " + palpate::describe(transition.start) + " of level " +
         std::to_string(transition.start_level) + " to " + palpate::describe(transition.target) +
         " of " + tool_space;
}

std::string describe(const IntermediateState& state, const std::string& tool_space) {
  return "intermediate state " + std::to_string(state.number) + " on the way to " +
         palpate::describe(state.target) + " of " + tool_space;
}

std::string describe(const TestPoint& point, const std::string& tool_space) {
  return "test point " + std::to_string(point.number) + " of " + tool_space;
}

std::string describe(const ReducedArrayRow& row) {
  return "array " + printable(row.name) + (row.num_arrays == 0 ? " of the training" : "") +
         " of the reduced model " + printable(row.model);
}

}  // namespace palpate::rows
