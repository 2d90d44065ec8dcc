// SPDX-License-Identifier: BSD-3-Clause
// What the fields of a finished space are reduced to: the table basis.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fields/packed_basis.h"
#include "storage/bodies.h"
#include "storage/connection.h"
#include "storage/rows.h"
#include "storage/table.h"
#include "storage/tool_spaces.h"

namespace palpate::storage {

/// A basis without its modes.
struct BasisBox {
  std::int64_t number = 0;
  CheckPointBox box;
  Keep keep = Keep::touch;
  /// That its modes make in a displacement, as a share of the largest one.
  double error = 0;
};

class Bases {
 public:
  Bases(Connection& connection, const Bodies& bodies, const ToolSpaces& tool_spaces)
      : connection_(connection), bodies_(bodies), tool_spaces_(tool_spaces) {}

  /// Stores a basis, in place of one of the same number. That one's modes must be the first of its
  /// own: what was reduced by them stays so.
  void add(const ToolSpaceKey& key, std::int64_t number, const PackedBasis& basis);
  /// The bases of a tool space, in the order of their numbers, and their boxes.
  [[nodiscard]] std::vector<BasisBox> list(const ToolSpaceKey& key) const;
  /// A basis, read when it is first asked for; null where it is damaged, and so left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> read(const ToolSpaceKey& key,
                                                       std::int64_t number) const;
  /// The basis that serves a check-point, or null.
  [[nodiscard]] std::shared_ptr<const FieldBasis> serving(const ToolSpaceKey& key,
                                                          const CheckPoint& check_point) const;
  /// What that keeps; nothing: none serves it.
  [[nodiscard]] std::optional<Keep> keep_at(const ToolSpaceKey& key,
                                            const CheckPoint& check_point) const;
  /// What is kept of the fields of all configurations: the least of any.
  [[nodiscard]] Keep keep() const;

  /// Gives back the memory of the bases that were read. They are read anew when they are asked for.
  void forget() const;
  /// Bases that were read, by tool space and checksum.
  using Known = std::map<std::pair<ToolSpaceKey, std::int64_t>, std::shared_ptr<const FieldBasis>>;
  /// Has this taken from here, and put here, that another object has read of the same file before.
  void share(Known& known) { known_ = &known; }
  /// Forgets all that was read, also what is shared.
  void forget_all() const;

  /// Reads what a conversion of the file writes again: all.
  [[nodiscard]] std::function<void()> read_for_conversion();

 private:
  /// A row of the table. The modes are read when they are first asked for.
  struct Stored {
    std::int64_t row_id = 0;
    std::int64_t checksum = 0;
    rows::BasisRow row;
    bool is_read = false;
    std::shared_ptr<const FieldBasis> basis;
  };
  /// Those of a tool space, in the order of their numbers.
  [[nodiscard]] std::vector<Stored>& stored(const ToolSpaceKey& key) const;
  /// Null where it is damaged, which is left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> basis_of(const ToolSpaceKey& key,
                                                           Stored& stored) const;
  [[nodiscard]] std::shared_ptr<const FieldBasis> read_new(const ToolSpaceKey& key,
                                                           const Stored& stored) const;
  /// Nothing where the modes are damaged.
  [[nodiscard]] std::optional<FieldBasis> read_modes(const Stored& stored,
                                                     std::int64_t num_kept) const;
  /// The same of version 9, where each mode has a row.
  [[nodiscard]] std::optional<FieldBasis> read_modes_of_9(const ToolSpaceKey& key,
                                                          const rows::BasisRow& row,
                                                          std::int64_t num_kept) const;
  /// Whether what is there explains so many modes.
  [[nodiscard]] bool are_explained(const ToolSpaceKey& key, const PackedBasis& head,
                                   std::int64_t num_kept) const;

  Connection& connection_;
  const Bodies& bodies_;
  const ToolSpaces& tool_spaces_;
  Table table_{"basis"};
  mutable std::map<ToolSpaceKey, std::vector<Stored>> stored_;
  mutable Known own_known_;
  Known* known_ = &own_known_;
};

}  // namespace palpate::storage
