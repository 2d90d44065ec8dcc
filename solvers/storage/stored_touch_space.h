// SPDX-License-Identifier: BSD-3-Clause
// Makes the touch space of a state space from its file.
#pragma once

#include "fields/reduced_fields.h"
#include "state_space/touch_space.h"
#include "storage/state_space_file.h"

namespace palpate {

/// Makes the touch space of a file, with the fields of a batch of configurations in
/// memory at a time. Where the file has modes, these are taken, and the bound does not matter.
/// Configurations whose fields are damaged or not finite are left out.
/// @throws InputError the bound is out of range.
[[nodiscard]] TouchSpace make_touch_space(const StateSpaceFile& file,
                                          double bound = kDefaultTouchBound);

/// Does the same without modes, for a program that renders forces and shows no body. No field is
/// read.
[[nodiscard]] TouchSpace make_touch_space_without_modes(const StateSpaceFile& file);

}  // namespace palpate
