// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRegions.h"

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

std::string vtkPalpateNameOfRegion(const vtkPalpateTissueSurfaces& tissues, int region)
{
  std::string text = std::to_string(tissues.Numbers.empty() ? region : tissues.Numbers[region]);
  return tissues.Names.empty() || tissues.Names[region].empty()
    ? text
    : text + " '" + tissues.Names[region] + "'";
}

vtkPalpateRegions::vtkPalpateRegions(
  const vtkPalpateCompartments& compartments, const vtkPalpateTissueSurfaces& tissues)
  : Compartments(compartments)
  , Tissues(tissues)
{
  for (int i = 1; i < Compartments.Count(); ++i)
  {
    if (Compartments.Region[i] != vtkPalpateCompartments::Empty)
    {
      VolumeOf[Compartments.Region[i]] += Compartments.Volume[i];
    }
  }
}

double vtkPalpateRegions::Volume() const
{
  double volume = 0;
  for (const auto& [region, part] : VolumeOf)
  {
    volume += part;
  }
  return volume;
}

void vtkPalpateRegions::RequireNoOverlap() const
{
  if (Compartments.Overlaps.empty())
  {
    return;
  }
  const auto& overlap = Compartments.Overlaps.front();
  const int i = overlap.Compartment;
  // For a layer the mean is its thickness; a lens is three times as thick in its middle.
  const double mean = 2 * Compartments.Volume[i] / vtkPalpateArea(Compartments.Boundary[i]);
  std::ostringstream text;
  text.precision(3);
  text << "The regions " << this->Name(overlap.Tissues[0]) << " and "
       << this->Name(overlap.Tissues[1]) << " overlap: both enclose " << this->Where(i)
       << ", between " << mean << " and " << 3 * mean
       << " m thick. If that is one wall, set WallTolerance to a little more than this. Else take "
          "that space away from one of them in the program that they come from, or give it as a "
          "region of its own. The second output shows it.";
  throw palpate::InputError(text.str());
}

std::string vtkPalpateRegions::Finish(vtkUnstructuredGrid* body) const
{
  auto* region = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Region"));
  std::map<int, double> volumes;
  for (vtkIdType i = 0; i < body->GetNumberOfCells(); ++i)
  {
    region->SetValue(i, this->Number(region->GetValue(i)));
    vtkIdType size;
    const vtkIdType* ids;
    body->GetCellPoints(i, size, ids);
    double p[4][3];
    for (int k = 0; k < 4; ++k)
    {
      body->GetPoint(ids[k], p[k]);
    }
    volumes[region->GetValue(i)] += vtkTetra::ComputeVolume(p[0], p[1], p[2], p[3]);
  }
  vtkNew<vtkIntArray> number;
  vtkNew<vtkDoubleArray> volume;
  vtkNew<vtkStringArray> name;
  number->SetName("RegionNumber");
  volume->SetName("RegionVolume");
  name->SetName("RegionName");
  for (const auto& [value, sum] : volumes)
  {
    number->InsertNextValue(value);
    volume->InsertNextValue(sum);
    const auto at = std::find(Tissues.Numbers.begin(), Tissues.Numbers.end(), value);
    name->InsertNextValue(Tissues.Names.empty() ? "" : Tissues.Names[at - Tissues.Numbers.begin()]);
  }
  body->GetFieldData()->AddArray(number);
  body->GetFieldData()->AddArray(volume);
  if (!Tissues.Names.empty())
  {
    body->GetFieldData()->AddArray(name);
  }
  return this->Doubt();
}

int vtkPalpateRegions::Number(int region) const
{
  return Tissues.Numbers.empty() ? region : Tissues.Numbers[region];
}

std::string vtkPalpateRegions::Where(int compartment) const
{
  const auto x = vtkPalpateMiddleOf(Compartments, compartment);
  std::ostringstream text;
  text << Compartments.Volume[compartment] << " m³ near (" << x[0] << ", " << x[1] << ", " << x[2]
       << ')';
  return text.str();
}

std::string vtkPalpateRegions::Doubt() const
{
  std::string text;
  for (const int i : Compartments.Doubtful)
  {
    text += "The walls around " + this->Where(i) +
      " belong to several regions; there is no wall between them, and region " +
      this->Name(Compartments.Region[i]) + ", which has most of them, got all. ";
  }
  for (int tissue = 0; tissue < static_cast<int>(Tissues.Numbers.size()); ++tissue)
  {
    if (VolumeOf.count(tissue) == 0)
    {
      text += "Region " + this->Name(tissue) + " encloses nothing of its own and is not there. ";
    }
  }
  return text;
}
