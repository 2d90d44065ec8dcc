// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSphereTool.h"

#include "interaction/rigid_tool.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkPalpateSphereTool);

void vtkPalpateSphereTool::DescribeShape(vtkPolyData*, palpate::RigidTool& tool) const
{
  tool.shape = palpate::ToolShape::sphere;
  tool.radius = this->Radius;
}

void vtkPalpateSphereTool::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Radius: " << this->Radius << " m\n";
}
