// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralize.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkPalpateEdgeField.h"
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
     << indent << "RefineRegion: " << this->RefineRegion.Get() << "\n"
     << indent << "RefineEdge: " << this->RefineEdge << " m\n"
     << indent << "EdgeGrowth: " << this->EdgeGrowth << "\n"
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

void vtkPalpateTetrahedralize::SetRefineRegion(vtkImplicitFunction* function)
{
  if (this->RefineRegion != function)
  {
    this->RefineRegion = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkPalpateTetrahedralize::GetRefineRegion() const
{
  return this->RefineRegion;
}

vtkMTimeType vtkPalpateTetrahedralize::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  // A region that refines nothing must not cause the body to be meshed again when it is moved.
  return this->RefineRegion && this->UsesRefineRegion()
    ? std::max(own, this->RefineRegion->GetMTime())
    : own;
}

vtkPalpateEdges vtkPalpateTetrahedralize::AskedEdges() const
{
  vtkPalpateEdges edges;
  edges.Region = this->RefineRegion;
  edges.RegionEdge = this->RefineEdge;
  edges.Growth = this->EdgeGrowth;
  return edges;
}

double vtkPalpateTetrahedralize::TetrahedraOfEdge(double volume) const
{
  // Measured: the mean volume of a tetrahedron whose longest edge is 1, and what the smaller ones
  // around the region add.
  constexpr double volumeOfEdge = 0.05;
  constexpr double around = 2;
  return this->RefineEdge > 0 ? around * volume / (volumeOfEdge * std::pow(this->RefineEdge, 3))
                              : 0;
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
  Require(this->RefineEdge >= 0 && std::isfinite(this->RefineEdge), "RefineEdge", this->RefineEdge,
    "a length in m, or 0 for none");
  Require(this->EdgeGrowth > 0 && std::isfinite(this->EdgeGrowth), "EdgeGrowth", this->EdgeGrowth,
    "above 0");
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
