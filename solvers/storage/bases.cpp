// SPDX-License-Identifier: BSD-3-Clause
#include "storage/bases.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "storage/stored_kind.h"

namespace palpate::storage {
namespace {

using sqlite::Statement;

/// A basis whose modes take no more memory than this is read, however few bytes it has in the file.
constexpr std::int64_t kAnyBasis = std::int64_t{64} << 20;

/// The configurations that were reduced to a basis with r modes have no fewer than r²/4
/// coefficients, since r is at most the number of their fields and derivatives. So three quarters
/// of the configurations may have been lost.
constexpr std::int64_t kMostModesSquared = 16;

}  // namespace

void Bases::add(const ToolSpaceKey& key, std::int64_t number, const PackedBasis& basis) {
  connection_.before_change();
  connection_.make_room(most_bytes(basis, bodies_.num_points(key.body)));
  const std::array<Statement::Blob, 2> modes = rows::modes_of(basis);
  const rows::BasisRow row{number, basis, rows::checksum(modes)};
  Statement insert(connection_.database(), table_.insert());
  insert.bind(key.body);
  insert.bind(key.id);
  rows::for_each_number_of_basis(row, rows::Bind{insert});
  insert.bind(rows::checksum(key, row));
  for (const Statement::Blob& blob : modes) insert.bind(blob.data, blob.bytes);
  insert.run();
  stored_.erase(key);
}

std::vector<BasisBox> Bases::list(const ToolSpaceKey& key) const {
  std::vector<BasisBox> boxes;
  for (const Stored& of_space : stored(key)) {
    const BasisHead& basis = of_space.row.basis;
    const double error =
        basis.largest_displacement > 0 ? basis.displacement_error / basis.largest_displacement : 0;
    boxes.push_back({of_space.row.number, basis.box, basis.keep, error});
  }
  return boxes;
}

std::shared_ptr<const FieldBasis> Bases::read(const ToolSpaceKey& key, std::int64_t number) const {
  for (Stored& of_space : stored(key)) {
    if (of_space.row.number == number) return basis_of(key, of_space);
  }
  return nullptr;
}

void Bases::forget() const {
  stored_.clear();
  own_known_.clear();
}

void Bases::forget_all() const {
  stored_.clear();
  known_->clear();
}

std::shared_ptr<const FieldBasis> Bases::serving(const ToolSpaceKey& key,
                                                 const CheckPoint& check_point) const {
  std::shared_ptr<const FieldBasis> basis;
  for (Stored& of_space : stored(key)) {
    if (of_space.row.basis.box.contains(check_point)) basis = basis_of(key, of_space);
  }
  return basis;
}

std::optional<Keep> Bases::keep_at(const ToolSpaceKey& key, const CheckPoint& check_point) const {
  for (const Stored& of_space : stored(key)) {
    if (of_space.row.basis.box.contains(check_point)) return of_space.row.basis.keep;
  }
  return std::nullopt;
}

Keep Bases::keep() const {
  if (connection_.version() < 9) return Keep::all;
  const sqlite::Database& database = connection_.database();
  if (database.integer("SELECT count(*) FROM basis") == 0) return Keep::all;
  return database.integer("SELECT min(keep) FROM basis") == 0 ? Keep::touch : Keep::surface;
}

std::function<void()> Bases::read_for_conversion() {
  struct Converted {
    ToolSpaceKey key;
    std::int64_t number;
    PackedBasis basis;
  };
  std::vector<Converted> all;
  for (const ToolSpace& space : tool_spaces_.read_all()) {
    const ToolSpaceKey key = space.setup.key();
    for (const BasisBox& box : list(key)) {
      const auto basis = read(key, box.number);
      if (basis != nullptr) all.push_back({key, box.number, pack(*basis)});
    }
  }
  return [this, all = std::move(all)] {
    for (const auto& [key, number, basis] : all) add(key, number, basis);
  };
}

std::vector<Bases::Stored>& Bases::stored(const ToolSpaceKey& key) const {
  const auto [found, is_new] = stored_.try_emplace(key);
  std::vector<Stored>& all = found->second;
  if (!is_new || connection_.version() < 9) return all;
  const std::int64_t num_points = bodies_.num_points(key.body);
  const std::int64_t num_cells = bodies_.head(key.body).num_cells;
  Statement select(connection_.database(),
                   "SELECT rowid, " + table_.columns("number", "checksum") +
                       ", checksum FROM basis WHERE scene_id = ? AND tool_space_id = ? ORDER BY "
                       "number");
  select.bind(key.body);
  select.bind(key.id);
  while (select.step()) {
    Stored& stored = all.emplace_back();
    stored.row_id = select.take_integer();
    bool sound = true;
    rows::for_each_number_of_basis(stored.row, rows::Take{select, sound});
    stored.checksum = select.take_integer();
    if (sound && stored.checksum == rows::checksum(key, stored.row, connection_.checked()) &&
        rows::is_possible(stored.row, num_points, num_cells)) {
      connection_.make_room(most_bytes(stored.row.basis, num_points));
      continue;
    }
    connection_.damage().leave_out("a basis of " + number_of(key), table_.name(), stored.row_id);
    all.pop_back();
  }
  return all;
}

std::shared_ptr<const FieldBasis> Bases::basis_of(const ToolSpaceKey& key, Stored& stored) const {
  if (stored.is_read) return stored.basis;
  stored.is_read = true;
  const auto found = known_->find({key, stored.checksum});
  if (found != known_->end()) return stored.basis = found->second;
  stored.basis = read_new(key, stored);
  if (stored.basis != nullptr) (*known_)[{key, stored.checksum}] = stored.basis;
  return stored.basis;
}

std::shared_ptr<const FieldBasis> Bases::read_new(const ToolSpaceKey& key,
                                                  const Stored& stored) const {
  const rows::BasisRow& row = stored.row;
  const auto num_kept =
      static_cast<std::int64_t>(bodies_.points_of(key.body, row.basis.keep).size());
  std::optional<FieldBasis> basis;
  if (rows::is_possible(row, num_kept, bodies_.head(key.body).num_cells) &&
      (row.basis.num_pressures == 0 ||
       row.basis.num_pressures == bodies_.num_pressures(key.body)) &&
      are_explained(key, row.basis, num_kept)) {
    basis = connection_.version() == 9 ? read_modes_of_9(key, row, num_kept)
                                       : read_modes(stored, num_kept);
  }
  if (!basis) {
    connection_.damage().leave_out("basis " + std::to_string(row.number) + " of " + number_of(key),
                                   table_.name(), stored.row_id);
    return nullptr;
  }
  return std::make_shared<const FieldBasis>(std::move(*basis));
}

std::optional<FieldBasis> Bases::read_modes(const Stored& stored, std::int64_t num_kept) const {
  Statement select(connection_.database(), "SELECT steps, modes FROM basis WHERE rowid = ?");
  select.bind(stored.row_id);
  if (!select.step()) return std::nullopt;
  std::array<Statement::Blob, 2> modes;
  for (Statement::Blob& blob : modes) blob = select.take_blob();
  if (rows::checksum(modes) != stored.row.modes_checksum) return std::nullopt;
  PackedBasis packed = stored.row.basis;
  if (!rows::set_modes(modes, num_kept, packed)) return std::nullopt;
  return unpack(packed, num_kept);
}

bool Bases::are_explained(const ToolSpaceKey& key, const PackedBasis& head,
                          std::int64_t num_kept) const {
  const std::int64_t most = std::max(head.num_modes, head.num_pressure_modes);
  if (most_bytes(head, num_kept) <= kAnyBasis) return true;
  Statement select(connection_.database(),
                   "SELECT coalesce(sum(length(u)), 0) FROM configuration WHERE scene_id = ? AND "
                   "tool_space_id = ?");
  select.bind(key.body);
  select.bind(key.id);
  select.step();
  const std::int64_t num_coefficients = select.take_integer() / std::int64_t{sizeof(float)};
  return most * most <= kMostModesSquared * num_coefficients;
}

std::optional<FieldBasis> Bases::read_modes_of_9(const ToolSpaceKey& key, const rows::BasisRow& row,
                                                 std::int64_t num_kept) const {
  const std::int64_t num_modes = row.basis.num_modes + row.basis.num_pressure_modes;
  constexpr char kOfBasis[] = " FROM mode WHERE scene_id = ? AND tool_space_id = ? AND basis = ?";
  // No memory is taken for modes that are not there.
  {
    Statement count(connection_.database(),
                    std::string("SELECT count(*), coalesce(sum(length(field)), 0)") + kOfBasis);
    count.bind(key.body);
    count.bind(key.id);
    count.bind(row.number);
    count.step();
    if (count.take_integer() != num_modes) return std::nullopt;
    const std::int64_t num_numbers =
        3 * num_kept * row.basis.num_modes + row.basis.num_pressures * row.basis.num_pressure_modes;
    if (count.take_integer() < num_numbers * std::int64_t{sizeof(Eigen::half)}) return std::nullopt;
  }
  FieldBasis basis;
  static_cast<BasisHead&>(basis) = row.basis;
  basis.modes.resize(3 * num_kept, row.basis.num_modes);
  basis.pressure_modes.resize(row.basis.num_pressures, row.basis.num_pressure_modes);
  basis.steps.setZero(num_modes);
  Statement select(connection_.database(),
                   std::string("SELECT of_pressure, number, checksum, field") + kOfBasis +
                       " ORDER BY of_pressure, number");
  select.bind(key.body);
  select.bind(key.id);
  select.bind(row.number);
  for (std::int64_t m = 0; m < num_modes; ++m) {
    if (!select.step()) return std::nullopt;
    rows::ModeKey mode{row.number, 0, 0};
    mode.of_pressure = select.take_integer();
    mode.number = select.take_integer();
    const std::int64_t checksum = select.take_integer();
    const Statement::Blob field = select.take_blob();
    const bool of_pressure = m >= row.basis.num_modes;
    Eigen::MatrixXf& modes = of_pressure ? basis.pressure_modes : basis.modes;
    const std::int64_t number = of_pressure ? m - row.basis.num_modes : m;
    const auto size = static_cast<std::size_t>(modes.rows());
    const bool is_half = field.bytes == size * sizeof(Eigen::half);
    if (mode.of_pressure != (of_pressure ? 1 : 0) || mode.number != number ||
        !(is_half || field.bytes == size * sizeof(float)) ||
        rows::checksum(key, mode, field) != checksum) {
      return std::nullopt;
    }
    auto column = modes.col(number);
    if (is_half) {
      Eigen::Matrix<Eigen::half, Eigen::Dynamic, 1> halves(modes.rows());
      if (size > 0) std::memcpy(halves.data(), field.data, field.bytes);
      column = halves.cast<float>();
    } else if (size > 0) {
      std::memcpy(column.data(), field.data, field.bytes);
    }
  }
  if (!basis.modes.allFinite() || !basis.pressure_modes.allFinite()) return std::nullopt;
  return basis;
}

}  // namespace palpate::storage
