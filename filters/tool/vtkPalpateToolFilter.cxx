// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateToolFilter.h"

#include <algorithm>

#include "vtkInformation.h"
#include "vtkPalpateInput.h"

vtkPalpateToolFilter::vtkPalpateToolFilter()
{
  this->SetNumberOfInputPorts(NumberOfInputs);
}

vtkPalpateToolFilter::~vtkPalpateToolFilter() = default;

void vtkPalpateToolFilter::AddActiveNode(vtkIdType node)
{
  this->ActiveNodes.push_back(node);
  this->Modified();
}

void vtkPalpateToolFilter::ClearActiveNodes()
{
  this->ActiveNodes.clear();
  this->Modified();
}

vtkMTimeType vtkPalpateToolFilter::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->Tool ? std::max(own, this->Tool->GetMTime()) : own;
}

int vtkPalpateToolFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == BodyPort ? "vtkUnstructuredGrid" : "vtkPolyData");
  if (port == SurfacePort)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

void vtkPalpateToolFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ActiveNodes:";
  for (const vtkIdType node : this->ActiveNodes)
  {
    os << ' ' << node;
  }
  os << '\n'
     << indent << "TipRadius: " << this->TipRadius << " m\n"
     << indent << "Tool: " << (this->Tool ? this->Tool->GetClassName() : "none") << '\n';
  if (this->Tool)
  {
    this->Tool->PrintSelf(os, indent.GetNextIndent());
  }
  os << indent << "BodyForce: " << this->BodyForce[0] << ' ' << this->BodyForce[1] << ' '
     << this->BodyForce[2] << " m/s^2\n"
     << indent << "MaximumSeconds: " << this->MaximumSeconds << " s\n"
     << indent << "Threads: " << this->Threads << '\n';
}
