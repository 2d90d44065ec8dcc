// SPDX-License-Identifier: BSD-3-Clause
// The exit codes of the programs that a filter starts, besides those of the libraries that they
// call (sysexits.h has the same numbers).
#pragma once

namespace vtkPalpateExitCode
{
constexpr int BadArguments = 64;
constexpr int BadData = 65;
}
