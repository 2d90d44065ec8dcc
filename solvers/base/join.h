// SPDX-License-Identifier: BSD-3-Clause
// A list as text, for messages: "liver, tumour".
#pragma once

#include <string>
#include <vector>

namespace palpate {

[[nodiscard]] inline std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace palpate
