// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFollowing.h"

#include <filesystem>
#include <map>
#include <utility>

namespace
{
std::map<std::filesystem::path, std::shared_ptr<palpate::LiveSpace>>& Spaces()
{
  static std::map<std::filesystem::path, std::shared_ptr<palpate::LiveSpace>> spaces;
  return spaces;
}

/// The same for all names of a file.
std::filesystem::path KeyOf(const std::string& file)
{
  std::error_code ignored;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(file, ignored);
  return whole.empty() ? std::filesystem::path(file) : whole;
}
}

void vtkPalpateSetLiveSpace(const std::string& file, std::shared_ptr<palpate::LiveSpace> space)
{
  if (space)
  {
    Spaces()[KeyOf(file)] = std::move(space);
  }
  else
  {
    Spaces().erase(KeyOf(file));
  }
}

std::shared_ptr<palpate::LiveSpace> vtkPalpateFindLiveSpace(const std::string& file)
{
  if (file.empty() || Spaces().empty())
  {
    return nullptr;
  }
  const auto found = Spaces().find(KeyOf(file));
  return found == Spaces().end() ? nullptr : found->second;
}
