// SPDX-License-Identifier: BSD-3-Clause
// The axis of an instrument, and its tip.
#pragma once

#include "interaction/rigid_tool.h"

struct vtkPalpateInstrument
{
  /// From the tip towards the handle, of unit length, in the tool's own axes.
  palpate::Vec3 Axis = palpate::Vec3::UnitZ();
  /// From the tool's centre, m: the centre of the end of a capsule at which its axis begins, the
  /// centre of a sphere, or where the axis of a surface leaves that.
  palpate::Vec3 Tip = palpate::Vec3::Zero();
};

/// @param axis 0: that of a capsule, and the longest side of the box around a surface. Of a capsule
///   it says no more than which end is the tip.
/// @throws palpate::InputError it is not finite.
vtkPalpateInstrument vtkPalpateInstrumentOf(
  const palpate::RigidTool& tool, const palpate::Vec3& axis);
