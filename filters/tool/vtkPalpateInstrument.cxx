// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateInstrument.h"

#include "base/error.h"

namespace
{
using palpate::Vec3;

/// Along the longest side of the box around a surface, in the direction of the axis of the scene.
Vec3 LongestSide(const palpate::RigidTool& tool)
{
  Eigen::AlignedBox3d box;
  for (const Vec3& point : tool.points)
  {
    box.extend(point);
  }
  Eigen::Index longest = 2;
  if (!box.isEmpty())
  {
    box.sizes().maxCoeff(&longest);
  }
  return Vec3::Unit(longest);
}
}

vtkPalpateInstrument vtkPalpateInstrumentOf(const palpate::RigidTool& tool, const Vec3& axis)
{
  if (!axis.allFinite())
  {
    throw palpate::InputError("InstrumentAxis must be finite.");
  }
  const bool isCapsule = tool.shape == palpate::ToolShape::capsule;
  const Vec3 own = isCapsule ? tool.axis.stableNormalized() : LongestSide(tool);
  vtkPalpateInstrument instrument;
  instrument.Axis = axis.isZero(0) ? own : axis.stableNormalized();
  if (isCapsule)
  {
    // Its axis is that of the shape, from the end that is said.
    instrument.Axis = own.dot(instrument.Axis) < 0 ? Vec3(-own) : own;
    instrument.Tip = -0.5 * tool.length * instrument.Axis;
  }
  else if (tool.shape != palpate::ToolShape::sphere)
  {
    instrument.Tip = -palpate::reach(tool, -instrument.Axis) * instrument.Axis;
  }
  return instrument;
}
