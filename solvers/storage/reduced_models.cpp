// SPDX-License-Identifier: BSD-3-Clause
#include "storage/reduced_models.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "storage/blob_sizes.h"
#include "storage/rows.h"
#include "storage/schema.h"

namespace palpate::storage {

using sqlite::Statement;
using sqlite::Transaction;

bool ReducedModels::has_any() const { return has_table(connection_.database(), table_.name()); }

void ReducedModels::insert(const std::string& key, const std::string& name, std::int64_t num_arrays,
                           const Eigen::MatrixXd& array) {
  constexpr std::int64_t kMost = blobs::kLargestRow - blobs::kOfNumbers;
  const auto bytes = static_cast<std::int64_t>(array.size()) * std::int64_t{sizeof(double)};
  if (bytes > kMost) {
    throw InputError("The array " + name + " of the reduced model has " + std::to_string(bytes) +
                     " bytes, and " + quoted(connection_.path()) + " holds " +
                     std::to_string(kMost) + " at the most. Take fewer modes, or a coarser mesh.");
  }
  connection_.make_room(bytes);
  const rows::ReducedArrayRow row{key, name, num_arrays, array.rows(), array.cols()};
  const Statement::Blob numbers{array.data(), static_cast<std::size_t>(bytes)};
  Statement statement(connection_.database(), table_.insert());
  statement.bind(body_);
  statement.bind(row.model);
  statement.bind(row.name);
  for (const std::int64_t x : {row.num_arrays, row.num_rows, row.num_columns}) statement.bind(x);
  statement.bind(rows::checksum(body_, row, numbers));
  // An address also where there are no numbers: it is no NULL.
  statement.bind(bytes > 0 ? numbers.data : &bytes, numbers.bytes);
  statement.run();
}

void ReducedModels::add(const std::string& key, const Arrays& arrays) {
  connection_.before_change();
  {
    Transaction transaction(connection_.database());
    make_table(connection_.database(), table_.name());
    Statement remove(connection_.database(),
                     "DELETE FROM reduced_array WHERE scene_id = ? AND model = ?");
    remove.bind(body_);
    remove.bind(key);
    remove.run();
    const auto num_arrays = static_cast<std::int64_t>(arrays.size());
    for (const auto& [name, array] : arrays) insert(key, name, num_arrays, array);
    transaction.commit();
  }
  connection_.checkpoint();
}

void ReducedModels::add_training(const std::string& key, const std::string& name,
                                 const Eigen::MatrixXd& array) {
  connection_.before_change();
  Transaction transaction(connection_.database());
  make_table(connection_.database(), table_.name());
  insert(key, name, 0, array);
  transaction.commit();
}

std::vector<std::string> ReducedModels::list() const {
  std::vector<std::string> keys;
  if (!has_any()) return keys;
  Statement select(connection_.database(),
                   "SELECT model FROM reduced_array WHERE scene_id = ? AND num_arrays > 0 GROUP BY "
                   "model HAVING count(*) = max(num_arrays) ORDER BY max(rowid)");
  select.bind(body_);
  while (select.step()) keys.push_back(select.take_text());
  return keys;
}

std::optional<Arrays> ReducedModels::read(const std::string& key) const {
  const std::vector<std::string> keys = list();
  if (std::find(keys.begin(), keys.end(), key) == keys.end()) return std::nullopt;
  const std::size_t left_out_before = connection_.damage().size();
  Arrays arrays = read_arrays(key, false);
  if (connection_.damage().size() != left_out_before || arrays.empty()) return std::nullopt;
  return arrays;
}

Arrays ReducedModels::read_training(const std::string& key) const { return read_arrays(key, true); }

void ReducedModels::check() const {
  if (!has_any()) return;
  std::vector<std::string> keys;
  {
    Statement select(connection_.database(),
                     "SELECT DISTINCT model FROM reduced_array WHERE scene_id = ?");
    select.bind(body_);
    while (select.step()) keys.push_back(select.take_text());
  }
  for (const std::string& key : keys) {
    for (const bool of_training : {false, true}) (void)read_arrays(key, of_training);
  }
}

void ReducedModels::make_room() const {
  if (!has_any()) return;
  connection_.make_room(
      connection_.database().integer("SELECT max(length(numbers)) FROM reduced_array"));
}

Arrays ReducedModels::read_arrays(const std::string& key, bool of_training) const {
  Arrays arrays;
  if (!has_any()) return arrays;
  // Read the sizes first, so that a row which claims more than its numbers take is not read.
  std::vector<std::pair<std::int64_t, rows::ReducedArrayRow>> heads;
  {
    Statement select(connection_.database(),
                     "SELECT rowid, " + table_.columns("model", "checksum") +
                         ", length(numbers) FROM reduced_array WHERE scene_id = ? AND model = ? "
                         "ORDER BY name");
    select.bind(body_);
    select.bind(key);
    while (select.step()) {
      const std::int64_t row_id = select.take_integer();
      rows::ReducedArrayRow row;
      row.model = select.take_text();
      row.name = select.take_text();
      for (std::int64_t* x : {&row.num_arrays, &row.num_rows, &row.num_columns}) {
        *x = select.take_integer();
      }
      const std::int64_t bytes = select.take_integer();
      const bool is_of_training = row.num_arrays == 0;
      if (is_of_training != of_training) continue;
      if (row.num_arrays < 0 || !rows::is_possible(row, bytes)) {
        connection_.damage().leave_out(rows::describe(row), table_.name(), row_id);
        continue;
      }
      connection_.make_room(bytes);
      heads.emplace_back(row_id, row);
    }
  }
  for (const auto& [row_id, row] : heads) {
    try {
      Statement select(connection_.database(),
                       "SELECT checksum, numbers FROM reduced_array WHERE rowid = ?");
      select.bind(row_id);
      if (select.step()) {
        const std::int64_t stored = select.take_integer();
        const Statement::Blob numbers = select.take_blob();
        const blobs::Size<double> size = blobs::array(row.num_rows, row.num_columns);
        if (size.fits(numbers.bytes) && stored == rows::checksum(body_, row, numbers)) {
          Eigen::MatrixXd array(row.num_rows, row.num_columns);
          if (blobs::copy(numbers, size, array)) {
            arrays[row.name] = std::move(array);
            continue;
          }
        }
      }
    } catch (const InputError&) {
      // The array cannot be read.
    }
    connection_.damage().leave_out(rows::describe(row), table_.name(), row_id);
  }
  return arrays;
}

}  // namespace palpate::storage
