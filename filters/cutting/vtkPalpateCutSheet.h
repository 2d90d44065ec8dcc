// SPDX-License-Identifier: BSD-3-Clause
// The sheet of a cut from a surface.
#pragma once

#include <string>

#include "cutting/sheet.h"

class vtkPolyData;

/// @param frontArray The point array along which the cut grows; "None": the direction says it.
/// @param direction In which the cut grows; zero: along the longer side of the sheet.
/// @param towards The cut then grows towards this place.
/// @throws palpate::InputError the surface is no sheet, or has no such array.
palpate::Sheet vtkPalpateSheetFromPolyData(vtkPolyData* surface, const std::string& frontArray,
  const palpate::Vec3& direction, const palpate::Vec3& towards);
