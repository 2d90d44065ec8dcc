// SPDX-License-Identifier: BSD-3-Clause
// What tells a state space from others: the hashes of its bodies' scenes, joined by "+".
#pragma once

#include <string>
#include <vector>

namespace palpate {

[[nodiscard]] std::string join_hashes(const std::vector<std::string>& hashes);

/// Whether two spaces are the same, or one of them is the other with more bodies. A space without
/// a hash is the same as none.
[[nodiscard]] bool is_same_space(const std::string& a, const std::string& b) noexcept;

}  // namespace palpate
