// SPDX-License-Identifier: BSD-3-Clause
// The paths of tools in time as a table, which may be written in a spreadsheet (.csv):
//
//   Time, Tool0_X, Tool0_Y, Tool0_Z, Tool1_X, …
//
// The table has a row for each time, s, in ascending order, and three columns for each tool, m. A
// column Tool0_Held, Tool1_Held, … says from which row on a tool is let go: it is 1 in the rows
// before and 0 from there on. Without this column the tool is held all the time. Other columns are
// ignored.
#pragma once

#include "dynamics/tool_path.h"

class vtkTable;

/// The number of tools in a table; 0 if the table is null.
int vtkPalpateCountTools(vtkTable* table);

/// The path of the tools in a table.
/// @throws palpate::InputError a column is missing or has no numbers, a tool is held again after it
///   was let go, or a column Tool…_Held has a number that is neither 0 nor 1; also as ToolPath.
palpate::ToolPath vtkPalpateToolPath(vtkTable* table);
