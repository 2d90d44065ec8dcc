// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetrahedralizeSurface.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "vtkFieldData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyMesh.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceRepair.h"
#include "vtkPalpateUnit.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

vtkStandardNewMacro(vtkPalpateTetrahedralizeSurface);

namespace
{
using palpate::InputError;

constexpr int LeastResolution = 16;
constexpr int GreatestResolution = 300; // half a gigabyte for a cube
/// More tetrahedra than this are a slip of a unit, not a wish.
constexpr double MostTetrahedra = 2e7;

/// The user wants no result any more.
struct Aborted
{
};

void AddText(vtkDataObject* output, const char* name, const std::string& text)
{
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  output->GetFieldData()->AddArray(array);
}
}

vtkPalpateTetrahedralizeSurface::vtkPalpateTetrahedralizeSurface()
  : Controller(vtkMultiProcessController::GetGlobalController())
{
  this->SetNumberOfOutputPorts(2);
}

vtkPalpateTetrahedralizeSurface::~vtkPalpateTetrahedralizeSurface() = default;

void vtkPalpateTetrahedralizeSurface::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Unit: " << this->Unit << "\n"
     << indent << "ElementOrder: " << this->ElementOrder << "\n"
     << indent << "MaximumRadiusEdgeRatio: " << this->MaximumRadiusEdgeRatio << "\n"
     << indent << "MaximumVolume: " << this->MaximumVolume << " m³\n"
     << indent << "PreserveSurface: " << this->PreserveSurface << "\n"
     << indent << "RepairSurface: " << this->RepairSurface << "\n"
     << indent << "RepairResolution: " << this->RepairResolution << "\n"
     << indent << "RefineRegion: " << this->RefineRegion.Get() << "\n"
     << indent << "RefineVolume: " << this->RefineVolume << " m³\n"
     << indent << "TimeOut: " << this->TimeOut << " s\n";
}

void vtkPalpateTetrahedralizeSurface::SetRefineRegion(vtkImplicitFunction* function)
{
  if (this->RefineRegion != function)
  {
    this->RefineRegion = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkPalpateTetrahedralizeSurface::GetRefineRegion() const
{
  return this->RefineRegion;
}

void vtkPalpateTetrahedralizeSurface::SetController(vtkMultiProcessController* controller)
{
  if (this->Controller != controller)
  {
    this->Controller = controller;
    this->Modified();
  }
}

vtkMultiProcessController* vtkPalpateTetrahedralizeSurface::GetController() const
{
  return this->Controller;
}

vtkMTimeType vtkPalpateTetrahedralizeSurface::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  // A region that refines nothing shall not mesh the body again when it is moved.
  return this->RefineRegion && this->RefineVolume > 0
    ? std::max(own, this->RefineRegion->GetMTime())
    : own;
}

int vtkPalpateTetrahedralizeSurface::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPolyData");
  return 1;
}

int vtkPalpateTetrahedralizeSurface::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  return 1;
}

int vtkPalpateTetrahedralizeSurface::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  input[0]->GetInformationObject(0)->Set(
    vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  return 1;
}

int vtkPalpateTetrahedralizeSurface::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  auto* body = vtkUnstructuredGrid::GetData(output, 0);
  auto* faults = vtkPolyData::GetData(output, 1);
  body->Initialize();
  faults->Initialize();

  this->ErrorCode = vtkPalpateProduce(this, body, this->Controller,
    [&]
    {
      // Every rank goes through the same calls of the controller, whatever happens on rank 0.
      const auto whole =
        vtkPalpateGatherSurface(vtkPalpateInput<vtkPolyData>(input[0]), this->Controller);
      if (!whole)
      {
        return;
      }
      try
      {
        this->Tetrahedralize(whole, body, faults);
      }
      catch (const Aborted&)
      {
        body->Initialize();
      }
    });
  return 1;
}

void vtkPalpateTetrahedralizeSurface::Validate() const
{
  const auto require = [](bool holds, const char* name, auto value, const char* range)
  {
    if (!holds)
    {
      std::ostringstream message;
      message << name << " is " << value << ", but must be " << range << ".";
      throw InputError(message.str());
    }
  };
  const auto volume = [](double value) { return value >= 0 && std::isfinite(value); };
  require(this->ElementOrder == Linear || this->ElementOrder == Quadratic, "ElementOrder",
    this->ElementOrder, "1 (Linear) or 2 (Quadratic)");
  require(this->MaximumRadiusEdgeRatio >= 1 && std::isfinite(this->MaximumRadiusEdgeRatio),
    "MaximumRadiusEdgeRatio", this->MaximumRadiusEdgeRatio, "at least 1");
  require(volume(this->MaximumVolume), "MaximumVolume", this->MaximumVolume,
    "a volume in m³, or 0 for none");
  require(volume(this->RefineVolume), "RefineVolume", this->RefineVolume,
    "a volume in m³, or 0 for none");
  require(this->RepairResolution >= LeastResolution && this->RepairResolution <= GreatestResolution,
    "RepairResolution", this->RepairResolution, "from 16 to 300 points");
  require(this->TimeOut >= 0, "TimeOut", this->TimeOut, "a time in s, or 0 for none");
}

void vtkPalpateTetrahedralizeSurface::Progress(double fraction)
{
  this->UpdateProgress(fraction);
  if (this->GetAbortExecute())
  {
    throw Aborted();
  }
}

void vtkPalpateTetrahedralizeSurface::Tetrahedralize(
  vtkPolyData* input, vtkUnstructuredGrid* body, vtkPolyData* fault_output)
{
  this->Validate();
  auto surface = vtkPalpateSurfaceFromPolyData(input);
  const double unit = vtkPalpateUnit::Length(this->Unit);
  for (vtkPalpatePoint& point : surface.Points)
  {
    for (double& coordinate : point)
    {
      coordinate *= unit;
    }
  }
  this->Progress(0.05);
  const auto faults = vtkPalpateCheckSurface(surface);
  vtkPalpateFaultsToPolyData(surface, faults, fault_output);
  this->Progress(0.1);

  vtkPalpateRepairOptions repair_options;
  repair_options.Resolution = this->RepairResolution;
  repair_options.Progress = [this](double fraction) { this->Progress(0.1 + 0.3 * fraction); };
  vtkPalpateRepairedSurface repaired;
  repaired.Report = "none";
  if (this->RepairSurface)
  {
    repaired = vtkPalpateRepairSurface(surface, repair_options);
  }
  else if (faults.None())
  {
    repaired.Surface = surface;
  }
  else
  {
    throw InputError("The surface bounds no body: " + vtkPalpateDescribeFaults(surface, faults) +
      ". Turn on RepairSurface, or mend the surface; the second output shows these places.");
  }

  const double volume = std::abs(vtkPalpateVolume(repaired.Surface));
  if (this->MaximumVolume > 0 && volume / this->MaximumVolume > MostTetrahedra)
  {
    std::ostringstream message;
    message << "MaximumVolume, " << this->MaximumVolume << " m³, asks for more than "
            << MostTetrahedra << " tetrahedra in a body of " << volume
            << " m³. Raise it, or correct the unit of the surface.";
    throw InputError(message.str());
  }

  vtkPalpateBodyMeshOptions options;
  options.TetGen.MaximumRadiusEdgeRatio = this->MaximumRadiusEdgeRatio;
  options.TetGen.MaximumVolume = this->MaximumVolume;
  options.TetGen.PreserveSurface = this->PreserveSurface;
  options.Quadratic = this->ElementOrder == Quadratic;
  options.RefineRegion = this->RefineRegion;
  options.RefineVolume = this->RefineVolume;

  const vtkPalpateTetGenLimits limits(
    this->TimeOut, [this](double fraction) { this->Progress(0.4 + 0.5 * fraction); });

  // TetGen gives up on some good surfaces. One that may be sampled anew gets further chances: on
  // another grid its triangles lie elsewhere.
  std::vector<int> resolutions = { this->RepairResolution * 5 / 4,
    std::max(LeastResolution, this->RepairResolution * 4 / 5) };
  if (!repaired.Resampled)
  {
    resolutions.insert(resolutions.begin(), this->RepairResolution);
  }
  auto next = resolutions.begin();
  for (bool meshed = false; !meshed;)
  {
    try
    {
      vtkPalpateMeshBody(repaired.Surface, options, limits, body);
      meshed = true;
    }
    catch (const vtkPalpateTetGenFailure& failure)
    {
      if (!this->RepairSurface || next == resolutions.end())
      {
        throw palpate::BackendError(std::string(failure.what()) +
          (this->RepairSurface ? " Try another RepairResolution, or mend the surface."
                               : " Turn on RepairSurface, or mend the surface."));
      }
      repair_options.ResampleAll = true;
      repair_options.Resolution = *next++;
      repaired = vtkPalpateRepairSurface(surface, repair_options);
    }
  }
  if (body->GetNumberOfCells() == 0)
  {
    throw palpate::BackendError("TetGen made no tetrahedra: the surface encloses " +
      std::to_string(volume) + " m³. Mend the surface.");
  }
  AddText(body, "Repair", repaired.Report);
  AddText(fault_output, "Repair", repaired.Report);
}
