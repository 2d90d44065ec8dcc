// SPDX-License-Identifier: BSD-3-Clause
// The sheet of a cut from a surface.
#pragma once

#include <string>

#include "cutting/sheet.h"

class vtkPolyData;

/// The point array by which Cut Plane says how the cut grows.
inline constexpr const char* vtkPalpateFrontOfSheet = "Front";

/// @param frontArray The point array along which the cut grows; "None": the direction says it.
/// @param direction In which the cut grows; zero: as the array `Front` of the sheet says, or, if
///   there is none, along the longer side of the sheet.
/// @param towards The cut then grows towards this place.
/// @throws palpate::InputError the surface is no sheet, or has no such array.
palpate::Sheet vtkPalpateSheetFromPolyData(vtkPolyData* surface, const std::string& frontArray,
  const palpate::Vec3& direction, const palpate::Vec3& towards);
