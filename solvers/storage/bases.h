// SPDX-License-Identifier: BSD-3-Clause
// The table basis: the modes to which the fields of a finished space are reduced.
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
  /// The largest error that its modes make in a displacement, as a share of the largest
  /// displacement.
  double error = 0;
};

class Bases {
 public:
  Bases(Connection& connection, const Bodies& bodies, const ToolSpaces& tool_spaces)
      : connection_(connection), bodies_(bodies), tool_spaces_(tool_spaces) {}

  /// Stores a basis, in place of one of the same number. Its first modes must be those of the
  /// replaced one, since fields that were reduced by them are kept as they are.
  void add(const ToolSpaceKey& key, std::int64_t number, const PackedBasis& basis);
  /// The bases of a tool space, in the order of their numbers, and their boxes.
  [[nodiscard]] std::vector<BasisBox> list(const ToolSpaceKey& key) const;
  /// A basis, read when it is first asked for; null where it is damaged, and so left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> read(const ToolSpaceKey& key,
                                                       std::int64_t number) const;
  /// The basis that serves a check-point, or null.
  [[nodiscard]] std::shared_ptr<const FieldBasis> serving(const ToolSpaceKey& key,
                                                          const CheckPoint& check_point) const;
  /// The part of the fields that this basis keeps; nothing: no basis serves the check-point.
  [[nodiscard]] std::optional<Keep> keep_at(const ToolSpaceKey& key,
                                            const CheckPoint& check_point) const;
  /// The part of the fields that is kept for every configuration: the least that any basis keeps.
  [[nodiscard]] Keep keep() const;

  /// Gives back the memory of the bases that were read. They are read anew when they are asked for.
  void forget() const;
  /// Bases that were read, by tool space and checksum.
  using Known = std::map<std::pair<ToolSpaceKey, std::int64_t>, std::shared_ptr<const FieldBasis>>;
  /// From now on bases are looked up in `known` before they are read, and are added to it, so that
  /// several objects of one file share what they have read.
  void share(Known& known) { known_ = &known; }
  /// Gives back the memory of everything that was read, also of what is shared.
  void forget_all() const;

  /// Reads all bases.
  /// @returns A function that writes them again, after the schema of the file was converted.
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
  /// The rows of a tool space, in the order of their numbers.
  [[nodiscard]] std::vector<Stored>& stored(const ToolSpaceKey& key) const;
  /// The basis of a row; null where it is damaged, and so left out.
  [[nodiscard]] std::shared_ptr<const FieldBasis> basis_of(const ToolSpaceKey& key,
                                                           Stored& stored) const;
  [[nodiscard]] std::shared_ptr<const FieldBasis> read_new(const ToolSpaceKey& key,
                                                           const Stored& stored) const;
  /// The basis with its modes; nothing where these are damaged.
  [[nodiscard]] std::optional<FieldBasis> read_modes(const Stored& stored,
                                                     std::int64_t num_kept) const;
  /// Does the same for a file of version 9, where each mode has a row.
  [[nodiscard]] std::optional<FieldBasis> read_modes_of_9(const ToolSpaceKey& key,
                                                          const rows::BasisRow& row,
                                                          std::int64_t num_kept) const;
  /// Whether the rows of the file can be what so many modes were made from.
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
