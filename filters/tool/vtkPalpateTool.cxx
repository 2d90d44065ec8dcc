// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTool.h"

#include <algorithm>
#include <utility>

#include "interaction/motion_kind.h"
#include "interaction/rigid_tool.h"
#include "interaction/shape_kind.h"
#include "vtkPalpateMotion.h"

vtkPalpateTool::vtkPalpateTool() = default;

vtkPalpateTool::~vtkPalpateTool() = default;

void vtkPalpateTool::SetMotion(vtkPalpateMotion* motion)
{
  if (this->Motion != motion)
  {
    this->Motion = motion;
    this->Modified();
  }
}

vtkPalpateMotion* vtkPalpateTool::GetMotion()
{
  return this->Motion;
}

vtkMTimeType vtkPalpateTool::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Motion ? std::max(own, this->Motion->GetMTime()) : own;
}

palpate::RigidTool vtkPalpateTool::Describe(vtkPolyData* surface) const
{
  palpate::RigidTool tool;
  this->DescribeShape(surface, tool);
  if (this->Motion)
  {
    this->Motion->Describe(tool);
  }
  tool.law = { this->ContactThickness, this->ContactStiffness };
  return tool;
}

void vtkPalpateTool::AddKind(std::unique_ptr<const palpate::ShapeKind> kind)
{
  palpate::add_shape_kind(std::move(kind));
}

void vtkPalpateTool::AddKind(std::unique_ptr<const palpate::MotionKind> kind)
{
  palpate::add_motion_kind(std::move(kind));
}

void vtkPalpateTool::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ContactThickness: " << this->ContactThickness << " m\n"
     << indent << "ContactStiffness: " << this->ContactStiffness << " Pa\n"
     << indent << "Motion: " << (this->Motion ? this->Motion->GetClassName() : "none") << '\n';
}
