// SPDX-License-Identifier: BSD-3-Clause
// The table reduced_array: reduced models, and what their training has found so far.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "state_space/tool_space.h"
#include "storage/connection.h"
#include "storage/table.h"

namespace palpate::storage {

/// The arrays of a reduced model by name, as those of reduced/model_arrays.h.
using Arrays = std::map<std::string, Eigen::MatrixXd>;

/// The reduced models of one body.
class ReducedModels {
 public:
  ReducedModels(Connection& connection, BodyId body) : connection_(connection), body_(body) {}

  /// Stores a reduced model, all of it or nothing, in place of one with the same key and of what
  /// its training has stored. It is durable when this returns.
  /// @param key Identifies the model: models that follow from the same input have the same key.
  /// @param arrays At least one.
  /// @throws InputError an array is larger than a row may be.
  void add(const std::string& key, const Arrays& arrays);
  /// The keys of the reduced models and of the trainings at places that are complete, in the order
  /// in which they were stored.
  [[nodiscard]] std::vector<std::string> list() const;
  /// The arrays of a model; nothing where there is no such model, or a part of it is damaged and so
  /// left out.
  [[nodiscard]] std::optional<Arrays> read(const std::string& key) const;

  /// Stores an array that the training of a model has found, in place of one of the same name.
  void add_training(const std::string& key, const std::string& name, const Eigen::MatrixXd& array);
  /// The arrays that the training of a model has stored, without damaged ones.
  [[nodiscard]] Arrays read_training(const std::string& key) const;

  /// Reads all arrays, so that damaged ones are noted as left out.
  void check() const;
  /// Lets a row be as large as the largest array.
  void make_room() const;

 private:
  [[nodiscard]] bool has_any() const;
  void insert(const std::string& key, const std::string& name, std::int64_t num_arrays,
              const Eigen::MatrixXd& array);
  /// The arrays of a model, or those of its training.
  [[nodiscard]] Arrays read_arrays(const std::string& key, bool of_training) const;

  Connection& connection_;
  BodyId body_;
  Table table_{"reduced_array"};
};

}  // namespace palpate::storage
