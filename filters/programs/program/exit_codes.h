// SPDX-License-Identifier: BSD-3-Clause
// What the programs that a filter starts end with where they fail, besides the codes of what they
// call (sysexits.h has the same numbers).
#pragma once

namespace vtkPalpateExitCode
{
constexpr int BadArguments = 64;
constexpr int BadData = 65;
}
