// SPDX-License-Identifier: BSD-3-Clause
// A state-space file that all ranks of a run write to: each a file of its own beside it
// (<path>.rank<r>), but rank 0, which writes to the file itself. They are merged at the end, or by
// the next run after a kill.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schedule/communicator.h"
#include "state_space/state_space_file.h"

namespace palpate {

class RankFiles {
 public:
  /// Nothing is touched before open().
  RankFiles(std::filesystem::path path, const Scene& scene, double solver_tolerance,
            Communicator& communicator)
      : path_(std::move(path)),
        scene_(scene),
        solver_tolerance_(solver_tolerance),
        communicator_(communicator) {}

  /// Opens or makes the files of all ranks.
  /// @param prepare It is called on each rank with the file of that rank.
  /// @throws InputError a file of another scene or tolerance.
  /// @note Collective
  void open(const std::function<void(StateSpaceFile&)>& prepare);

  /// The file of this rank. After merge() only rank 0 has one.
  [[nodiscard]] StateSpaceFile& own() { return *own_; }
  [[nodiscard]] const StateSpaceFile& own() const { return *own_; }

  /// What open() has found damaged in the file and so has removed from it, see
  /// StateSpaceFile::left_out(); empty on other ranks than 0.
  [[nodiscard]] const std::vector<std::string>& damaged() const { return damaged_; }

  /// Removes the files of the other ranks, whose content is in that of rank 0 by other means.
  /// @note Collective
  void discard_others();

  /// Moves everything into the file of rank 0, and removes the other files.
  /// @throws InputError the file of a rank is damaged: what is sound in it was taken over, and it
  ///   stays.
  /// @note Collective
  void merge();

 private:
  [[nodiscard]] std::vector<std::filesystem::path> left_by_ranks(
      const std::string& ending = "") const;
  void take_over();

  std::filesystem::path path_;
  const Scene& scene_;
  double solver_tolerance_;
  Communicator& communicator_;
  std::optional<StateSpaceFile> own_;
  std::vector<std::string> damaged_;
};

}  // namespace palpate
