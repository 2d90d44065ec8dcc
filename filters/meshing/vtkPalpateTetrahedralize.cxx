// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralize.h"

#include <cmath>
#include <sstream>

#include "base/error.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateEstimate.h"

vtkPalpateTetrahedralize::vtkPalpateTetrahedralize()
  : Controller(vtkMultiProcessController::GetGlobalController())
{
  this->SetNumberOfOutputPorts(2);
}

vtkPalpateTetrahedralize::~vtkPalpateTetrahedralize() = default;

void vtkPalpateTetrahedralize::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Unit: " << this->Unit << "\n"
     << indent << "ElementOrder: " << this->ElementOrder << "\n"
     << indent << "MaximumRadiusEdgeRatio: " << this->MaximumRadiusEdgeRatio << "\n"
     << indent << "TimeOut: " << this->TimeOut << " s\n"
     << indent << "Estimate: " << this->Estimate << "\n";
}

void vtkPalpateTetrahedralize::SetController(vtkMultiProcessController* controller)
{
  if (this->Controller != controller)
  {
    this->Controller = controller;
    this->Modified();
  }
}

vtkMultiProcessController* vtkPalpateTetrahedralize::GetController() const
{
  return this->Controller;
}

int vtkPalpateTetrahedralize::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  return 1;
}

void vtkPalpateTetrahedralize::UpdateEstimate()
{
  this->Estimate = vtkPalpateEstimate(this->Controller, [this] { return this->MakeEstimate(); });
}

void vtkPalpateTetrahedralize::Require(
  bool holds, const std::string& name, double value, const char* range)
{
  if (!holds)
  {
    std::ostringstream message;
    message << name << " is " << value << ", but must be " << range << ".";
    throw palpate::InputError(message.str());
  }
}

void vtkPalpateTetrahedralize::Validate() const
{
  Require(this->ElementOrder == Linear || this->ElementOrder == Quadratic, "ElementOrder",
    this->ElementOrder, "1 (Linear) or 2 (Quadratic)");
  Require(this->MaximumRadiusEdgeRatio >= 1 && std::isfinite(this->MaximumRadiusEdgeRatio),
    "MaximumRadiusEdgeRatio", this->MaximumRadiusEdgeRatio, "at least 1");
  Require(this->TimeOut >= 0, "TimeOut", this->TimeOut, "a time in s, or 0 for none");
}

void vtkPalpateTetrahedralize::Progress(double fraction)
{
  this->UpdateProgress(fraction);
  if (this->GetAbortExecute())
  {
    throw Aborted();
  }
}
