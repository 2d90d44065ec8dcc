// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/rank_files.h"

#include <algorithm>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/folder.h"
#include "base/printable.h"

namespace palpate {
namespace fs = std::filesystem;

namespace {

/// The ending that NewFile gives to a file that is not complete yet.
constexpr char kPart[] = ".part";

[[noreturn]] void throw_not_removed(const fs::path& file, const std::error_code& error) {
  throw BackendError("The file " + quoted(file) +
                     ", whose content is in that of the state space now, cannot be removed: " +
                     error.message() + ". Remove it by hand.");
}

}  // namespace

void RankFiles::open(const std::function<void(StateSpaceFile&)>& prepare) {
  // Rank 0 goes first: if it fails, no other rank leaves a file behind.
  agree(communicator_, [&] {
    if (communicator_.rank() != 0) return;
    if (const auto left = left_by_ranks(); !left.empty() && !fs::exists(path_)) {
      throw InputError(
          "The file " + quoted(path_) + " is gone, but " + quoted(left.front()) +
          " of its last run is there, which holds what that has computed. Bring the file back, "
          "or move the other away, or give another file name.");
    }
    const bool was_there = fs::exists(path_);
    for (const SpaceBody& body : bodies_) StateSpaceFile::require_size(*body.scene);
    const SpaceBody& first = bodies_.front();
    own_ = StateSpaceFile::open_or_create(path_, *first.scene, solver_tolerance_, first.at_rest);
    require_order();
    if (was_there) damaged_ = own_->remove_damaged();
    take_over();
    add_bodies(prepare);
  });
  agree(communicator_, [&] {
    if (communicator_.rank() == 0) return;
    own_ =
        StateSpaceFile::create(path_.string() + ".rank" + std::to_string(communicator_.rank()),
                               *bodies_.front().scene, solver_tolerance_, bodies_.front().at_rest);
    add_bodies(prepare);
  });
}

void RankFiles::require_order() const {
  BodyId next = own_->list_bodies().back() + 1;
  for (const SpaceBody& body : bodies_) {
    const std::optional<BodyId> there = own_->find_body(body.hash);
    const BodyId number = there ? *there : next++;
    if (number == body.number) continue;
    throw InputError(quoted(path_) + " holds body " + std::to_string(body.number) +
                     " of this run as its body " + std::to_string(number) +
                     ". Give the bodies of the file in their order, or another file name.");
  }
}

void RankFiles::add_bodies(const std::function<void(StateSpaceFile&)>& prepare) {
  own_->change_together([&] {
    for (const SpaceBody& body : bodies_) own_->add_body(body);
    prepare(*own_);
  });
}

void RankFiles::merge() {
  agree(communicator_, [&] {
    if (communicator_.rank() != 0) own_->close();
  });
  agree(communicator_, [&] {
    if (communicator_.rank() == 0) take_over();
  });
}

void RankFiles::discard_others() {
  agree(communicator_, [&] {
    if (communicator_.rank() == 0) return;
    const fs::path path = own_->path();
    own_->close();
    std::error_code error;
    if (!fs::remove(path, error)) throw_not_removed(path, error);
    sync_folder_of(path_);
  });
}

/// The files with this ending that ranks of this run, or of an earlier, killed one, have left.
std::vector<fs::path> RankFiles::left_by_ranks(const std::string& ending) const {
  std::vector<fs::path> files;
  const std::string prefix = path_.filename().string() + ".rank";
  for (const std::string& name : names_beside(path_)) {
    if (name.compare(0, prefix.size(), prefix) != 0) continue;
    const std::size_t digits_end =
        std::min(name.find_first_not_of("0123456789", prefix.size()), name.size());
    const std::string rest = name.substr(digits_end);
    // The name of an incomplete file has random characters before its ending.
    const bool is_part = ending == kPart && rest.size() >= ending.size() &&
                         rest.compare(rest.size() - ending.size(), ending.size(), ending) == 0;
    if (digits_end > prefix.size() && (rest == ending || is_part)) {
      files.push_back(path_.parent_path() / name);
    }
  }
  return files;
}

/// Merges and removes the files one by one, so that no more than one of them is on the disk twice.
/// A file is removed once its content is durable in this one.
void RankFiles::take_over() {
  for (const fs::path& file : left_by_ranks()) {
    const std::vector<std::string> left_out = own_->merge(file);
    if (!left_out.empty()) {
      throw InputError(
          describe_left_out(file, left_out) + " All else of it is in " + path_.string() +
          " now. Move the file away, and run again: " + "what is missing is computed again.");
    }
    std::error_code error;
    if (!fs::remove(file, error)) throw_not_removed(file, error);
  }
  // Remains of a file that was being created or removed when the power was lost.
  for (const char* ending : {kPart, "-journal", "-wal"}) {
    for (const fs::path& remains : left_by_ranks(ending)) fs::remove(remains);
  }
  sync_folder_of(path_);
}

}  // namespace palpate
