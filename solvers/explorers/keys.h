// SPDX-License-Identifier: BSD-3-Clause
// The keys of an exploration around a hand. Who explores and who is explored for know each other by
// the public keys of CurveZMQ, and all that they send is encrypted. The keys are in a folder, in
// the files of ZeroMQ's certificates:
//
//   leader, leader_secret                              who has the session
//   explorers/explorer, explorers/explorer_secret      its explorers
//
// An explorer needs leader and explorer_secret. Other public keys in explorers/ are admitted too.
#pragma once

#include <filesystem>

namespace palpate {

/// The files of the folder.
[[nodiscard]] std::filesystem::path leader_key(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path explorer_keys(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path explorer_key(const std::filesystem::path& folder);

/// Makes the folder, which its owner alone can read, and new keys, unless it has some.
/// @throws InputError the folder or the files cannot be made, or others can read the secret keys.
void make_keys(const std::filesystem::path& folder);
/// Checks the keys that a leader, or an explorer, needs.
/// @throws InputError one is missing; others can read a secret key, or put keys into the folder; or
///   a key is there twice.
void check_leader_keys(const std::filesystem::path& folder);
void check_explorer_keys(const std::filesystem::path& folder);

/// A folder of new keys, which are removed at the end; or one that is there already, which stays.
class KeysFolder {
 public:
  /// @param given Empty: a new one, where files for a while are.
  /// @throws BackendError no folder can be made there. @throws InputError As make_keys().
  explicit KeysFolder(std::filesystem::path given = {});
  ~KeysFolder();
  KeysFolder(const KeysFolder&) = delete;
  KeysFolder& operator=(const KeysFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool is_own_ = false;
};

}  // namespace palpate
