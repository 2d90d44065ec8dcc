// SPDX-License-Identifier: BSD-3-Clause
// The way of tools in time as a table, which anybody may write in a spreadsheet (.csv):
//
//   Time, Tool0_X, Tool0_Y, Tool0_Z, Tool1_X, …
//
// a row for each time, s, in ascending order, and three columns for each tool, m. A column
// Tool0_Held, Tool1_Held, … says from which row on a tool is let go: 1 in the rows before, 0 from
// there on; without one it is held all the time. Other columns are left out.
#pragma once

#include "dynamics/tool_path.h"

class vtkTable;

/// How many tools a table has; 0 where it is null.
int vtkPalpateCountTools(vtkTable* table);

/// Their path.
/// @throws palpate::InputError a column that is missing, or has no numbers; a tool that is held
///   again, or a number there that is neither 0 nor 1; and as ToolPath.
palpate::ToolPath vtkPalpateToolPath(vtkTable* table);
