// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCapsuleTool.h"

#include "interaction/rigid_tool.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkPalpateCapsuleTool);

void vtkPalpateCapsuleTool::DescribeShape(vtkPolyData*, palpate::RigidTool& tool) const
{
  tool.shape = palpate::ToolShape::capsule;
  tool.radius = this->Radius;
  tool.axis = palpate::Vec3(this->Axis);
  tool.length = this->Length;
}

void vtkPalpateCapsuleTool::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Radius: " << this->Radius << " m\n"
     << indent << "Axis: " << this->Axis[0] << ' ' << this->Axis[1] << ' ' << this->Axis[2] << '\n'
     << indent << "Length: " << this->Length << " m\n";
}
