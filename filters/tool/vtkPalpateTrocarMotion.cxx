// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTrocarMotion.h"

#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/rigid_tool.h"
#include "interaction/trocar_pose.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkPalpateTrocarMotion);

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

void vtkPalpateTrocarMotion::Describe(palpate::RigidTool& tool) const
{
  const Vec3 given(this->InstrumentAxis);
  palpate::Trocar trocar;
  trocar.place = Vec3(this->TrocarPoint);
  if (!trocar.place.allFinite() || !given.allFinite())
  {
    throw palpate::InputError("TrocarPoint and InstrumentAxis must be finite.");
  }
  const bool isCapsule = tool.shape == palpate::ToolShape::capsule;
  const Vec3 own = isCapsule ? tool.axis.stableNormalized() : LongestSide(tool);
  trocar.axis = given.isZero(0) ? own : given.stableNormalized();
  if (isCapsule)
  {
    // Its axis is that of the shape, from the end that is said.
    trocar.axis = own.dot(trocar.axis) < 0 ? Vec3(-own) : own;
    trocar.tip = -0.5 * tool.length * trocar.axis;
  }
  else if (tool.shape != palpate::ToolShape::sphere)
  {
    trocar.tip = -palpate::reach(tool, -trocar.axis) * trocar.axis;
  }
  if (!(this->MaximumTilt > 0 && this->MaximumTilt <= 90))
  {
    throw palpate::InputError("MaximumTilt is " + palpate::quantity(this->MaximumTilt, "degrees") +
      ", but must be above 0 and at most 90.");
  }
  if (!(this->MaximumDepth >= 0) || !std::isfinite(this->MaximumDepth))
  {
    throw palpate::InputError("MaximumDepth is " + palpate::quantity(this->MaximumDepth, "m") +
      ", but must be a length, or 0.");
  }
  trocar.tilt = this->MaximumTilt * M_PI / 180;
  trocar.depth = this->MaximumDepth;
  // palpate::with_defaults() finds the direction from the body.
  trocar.towards.setZero();
  tool.motion = palpate::ToolMotion::trocar;
  tool.motion_numbers = trocar.numbers();
}

void vtkPalpateTrocarMotion::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&](const char* name, const double* v, const char* unit)
  { os << indent << name << ": " << v[0] << ' ' << v[1] << ' ' << v[2] << unit << '\n'; };
  print("TrocarPoint", this->TrocarPoint, " m");
  print("InstrumentAxis", this->InstrumentAxis, "");
  os << indent << "MaximumTilt: " << this->MaximumTilt << " degrees\n";
  os << indent << "MaximumDepth: " << this->MaximumDepth << " m\n";
}
