// SPDX-License-Identifier: BSD-3-Clause
// A state-space file that all ranks of a run write to. Rank 0 writes to the file itself, and each
// other rank to a file of its own beside it (<path>.rank<r>). The files are merged at the end, or
// after a kill by the next run.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schedule/communicator.h"
#include "storage/state_space_file.h"

namespace palpate {

class RankFiles {
 public:
  /// The files are not touched before open().
  /// @param bodies The bodies of the run. Those of the file must be the same in the same order, as
  ///   far as both go; then a body has one number in the run and in all files. They must outlive
  ///   this object.
  RankFiles(std::filesystem::path path, const std::vector<SpaceBody>& bodies,
            double solver_tolerance, Communicator& communicator)
      : path_(std::move(path)),
        bodies_(bodies),
        solver_tolerance_(solver_tolerance),
        communicator_(communicator) {}

  /// Opens or creates the files of all ranks.
  /// @param prepare Called on each rank with the file of that rank.
  /// @throws InputError a file of another scene or tolerance, or with the bodies in another order.
  /// @note Collective
  void open(const std::function<void(StateSpaceFile&)>& prepare);

  /// The file of this rank. After merge(), only that of rank 0 is open.
  [[nodiscard]] StateSpaceFile& own() { return *own_; }
  [[nodiscard]] const StateSpaceFile& own() const { return *own_; }

  /// On rank 0: damaged parts that open() has removed from the file, see
  /// StateSpaceFile::left_out(); empty elsewhere.
  [[nodiscard]] const std::vector<std::string>& damaged() const { return damaged_; }

  /// Removes the files of the other ranks, when their content is in the file of rank 0 by other
  /// means.
  /// @note Collective
  void discard_others();

  /// Moves the content of all files into that of rank 0, and removes the others.
  /// @throws InputError the file of a rank is damaged. Its sound part was taken over, and the file
  ///   stays.
  /// @note Collective
  void merge();

 private:
  [[nodiscard]] std::vector<std::filesystem::path> left_by_ranks(
      const std::string& ending = "") const;
  void take_over();
  /// @throws InputError the file has bodies of the run in another order.
  void require_order() const;
  /// Adds the bodies of the run to the file of this rank, and prepares it: both or nothing.
  void add_bodies(const std::function<void(StateSpaceFile&)>& prepare);

  std::filesystem::path path_;
  const std::vector<SpaceBody>& bodies_;
  double solver_tolerance_;
  Communicator& communicator_;
  std::optional<StateSpaceFile> own_;
  std::vector<std::string> damaged_;
};

}  // namespace palpate
