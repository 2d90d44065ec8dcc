// SPDX-License-Identifier: BSD-3-Clause
// Makes the checksums of a state-space file right again after its rows were changed, as anybody can
// who knows schema.sql.h.
#pragma once

#include <filesystem>

namespace palpate::test {

void seal(const std::filesystem::path& file);

}  // namespace palpate::test
