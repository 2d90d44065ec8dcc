// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/keys.h"

#include <czmq.h>

#include <cstdlib>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "explorers/handles.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path secret(const fs::path& file) { return file.string() + "_secret"; }

void make_key(const fs::path& file) {
  if (fs::exists(secret(file))) return;
  const Certificate key(zcert_new());
  if (zcert_save(key.get(), file.c_str()) != 0) {
    throw InputError("The key " + file.string() + " cannot be written. Choose another folder.");
  }
}

/// @throws InputError others have one of these rights.
void require_own(const fs::path& path, fs::perms rights, const char* what) {
  std::error_code error;
  const fs::perms perms = fs::status(path, error).permissions();
  if (error || (perms & rights) == fs::perms::none) return;
  throw InputError("Others may " + std::string(what) + ' ' + path.string() +
                   ". Take that right away from them (chmod go= " + path.string() +
                   "), or make new keys in another folder.");
}

void require_secret(const fs::path& key) {
  const fs::path file = secret(key);
  if (!fs::exists(file)) {
    throw InputError("There is no key " + file.string() +
                     ". Make keys first (palpate-explore --make-keys), or copy those of the "
                     "session there.");
  }
  require_own(file, fs::perms::group_all | fs::perms::others_all, "read the secret key");
}

/// Whoever can put keys there is admitted.
void require_folder(const fs::path& folder) {
  require_own(folder, fs::perms::group_write | fs::perms::others_write, "put keys into");
}

}  // namespace

fs::path leader_key(const fs::path& folder) { return folder / "leader"; }
fs::path explorer_keys(const fs::path& folder) { return folder / "explorers"; }
fs::path explorer_key(const fs::path& folder) { return explorer_keys(folder) / "explorer"; }

void make_keys(const fs::path& folder) {
  prepare_messages();
  std::error_code error;
  for (const fs::path& each : {folder, explorer_keys(folder)}) {
    const bool is_new = fs::create_directories(each, error);
    if (error) {
      throw InputError("The folder of keys " + each.string() +
                       " cannot be made: " + error.message() + ". Choose another one.");
    }
    if (is_new) fs::permissions(each, fs::perms::owner_all, error);
  }
  for (const fs::path& key : {leader_key(folder), explorer_key(folder)}) {
    make_key(key);
    require_secret(key);
  }
}

void check_leader_keys(const fs::path& folder) {
  prepare_messages();
  require_secret(leader_key(folder));
  require_folder(folder);
  require_folder(explorer_keys(folder));
  std::map<std::string, fs::path> known;
  for (const auto& entry : fs::directory_iterator(explorer_keys(folder))) {
    const std::string name = entry.path().filename().string();
    const bool is_secret = name.size() > 7 && name.substr(name.size() - 7) == "_secret";
    if (is_secret) continue;
    const Certificate key(zcert_load(entry.path().c_str()));
    if (key == nullptr) continue;
    const auto [first, is_new] = known.emplace(zcert_public_txt(key.get()), entry.path());
    if (!is_new) {
      throw InputError("The keys " + first->second.string() + " and " + entry.path().string() +
                       " are the same. Move one of them to another folder.");
    }
  }
}

void check_explorer_keys(const fs::path& folder) {
  prepare_messages();
  require_secret(explorer_key(folder));
  if (!fs::exists(leader_key(folder))) {
    throw InputError("There is no key " + leader_key(folder).string() +
                     ". Copy that of the session there.");
  }
}

KeysFolder::KeysFolder(fs::path given) : path_(std::move(given)) {
  if (!path_.empty()) return;
  std::string made = (fs::temp_directory_path() / "palpate_keys_XXXXXX").string();
  if (mkdtemp(made.data()) == nullptr) {
    throw BackendError("No folder for the keys of explorers can be made in " +
                       fs::temp_directory_path().string() +
                       ". Set TMPDIR to a folder in which you may write.");
  }
  path_ = made;
  is_own_ = true;
  make_keys(path_);
}

KeysFolder::~KeysFolder() {
  std::error_code ignored;
  if (is_own_) fs::remove_all(path_, ignored);
}

}  // namespace palpate
