// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTrocarMotion.h"

#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/rigid_tool.h"
#include "interaction/trocar_pose.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateInstrument.h"

vtkStandardNewMacro(vtkPalpateTrocarMotion);

void vtkPalpateTrocarMotion::Describe(palpate::RigidTool& tool) const
{
  const vtkPalpateInstrument instrument =
    vtkPalpateInstrumentOf(tool, palpate::Vec3(this->InstrumentAxis));
  palpate::Trocar trocar;
  trocar.place = palpate::Vec3(this->TrocarPoint);
  if (!trocar.place.allFinite())
  {
    throw palpate::InputError("TrocarPoint must be finite.");
  }
  trocar.axis = instrument.Axis;
  trocar.tip = instrument.Tip;
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
