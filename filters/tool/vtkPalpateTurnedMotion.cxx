// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTurnedMotion.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/rigid_tool.h"
#include "interaction/turned_pose.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateInstrument.h"

vtkStandardNewMacro(vtkPalpateTurnedMotion);

void vtkPalpateTurnedMotion::Describe(palpate::RigidTool& tool) const
{
  const vtkPalpateInstrument instrument =
    vtkPalpateInstrumentOf(tool, palpate::Vec3(this->InstrumentAxis));
  if (!std::isfinite(this->ReferenceDistance))
  {
    throw palpate::InputError("ReferenceDistance must be finite.");
  }
  if (!(this->MaximumTurn > 0 && this->MaximumTurn < 180))
  {
    throw palpate::InputError("MaximumTurn is " + palpate::quantity(this->MaximumTurn, "degrees") +
      ", but must be above 0 and below 180.");
  }
  palpate::Turning turning;
  if (tool.shape != palpate::ToolShape::surface || this->Axisymmetric)
  {
    turning.axis = instrument.Axis;
  }
  turning.point = instrument.Tip + this->ReferenceDistance * instrument.Axis;
  turning.orientation = palpate::orientation_of({ this->MiddleOrientation[0],
    this->MiddleOrientation[1], this->MiddleOrientation[2], this->MiddleOrientation[3] });
  turning.lever =
    std::max(palpate::reach(tool, instrument.Axis), palpate::reach(tool, -instrument.Axis));
  turning.farthest = this->MaximumTurn * M_PI / 180;
  tool.motion = palpate::ToolMotion::turned;
  tool.motion_numbers = turning.numbers();
}

void vtkPalpateTurnedMotion::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const double* axis = this->InstrumentAxis;
  const double* middle = this->MiddleOrientation;
  os << indent << "InstrumentAxis: " << axis[0] << ' ' << axis[1] << ' ' << axis[2] << '\n'
     << indent << "ReferenceDistance: " << this->ReferenceDistance << " m\n"
     << indent << "Axisymmetric: " << this->Axisymmetric << '\n'
     << indent << "MiddleOrientation: " << middle[0] << ' ' << middle[1] << ' ' << middle[2] << ' '
     << middle[3] << '\n'
     << indent << "MaximumTurn: " << this->MaximumTurn << " degrees\n";
}
