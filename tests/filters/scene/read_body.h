// SPDX-License-Identifier: BSD-3-Clause
// This header has no VTK in it: VTK has a copy of the JSON library under another name, and a source
// cannot include both.
#pragma once

#include <string>

#include "assembly/body.h"

/// The body of a file: its mesh and where it is held (the array Fixed); all else of its surface may
/// be touched.
palpate::Body ReadBody(const std::string& file);
