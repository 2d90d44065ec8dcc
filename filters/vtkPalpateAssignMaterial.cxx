// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateAssignMaterial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/error.h"
#include "materials/material.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Formulation;
using palpate::InputError;
using palpate::Law;

/// Values of a region array are told apart by more than this share: an array in single precision
/// holds 0.1 only to 1e-8.
constexpr double RegionTolerance = 1e-6;

Law CheckedLaw(int number)
{
  if (number < 0 || number >= palpate::num_laws)
  {
    throw InputError("Law is " + std::to_string(number) + "; there are the laws 0 to " +
      std::to_string(palpate::num_laws - 1) + ".");
  }
  return static_cast<Law>(number);
}

/// By the names of the parameters, of rows r, s, C_rs.
std::map<std::string, double> CoefficientsByName(const std::vector<std::array<double, 3>>& rows)
{
  if (rows.empty())
  {
    throw InputError(
      "Coefficients is empty; the law needs rows of the powers r and s and of C_rs.");
  }
  std::map<std::string, double> values;
  for (const auto& [r, s, value] : rows)
  {
    const auto known =
      std::find_if(palpate::polynomial_powers.begin(), palpate::polynomial_powers.end(),
        [r = r, s = s](const std::array<int, 2>& powers)
        { return powers[0] == r && powers[1] == s; });
    if (known == palpate::polynomial_powers.end())
    {
      std::ostringstream text;
      text << "Coefficients has the powers r = " << r << " and s = " << s
           << "; they must be whole numbers, not negative, with a sum of 1, 2 or 3.";
      throw InputError(text.str());
    }
    const std::string name = 'C' + std::to_string((*known)[0]) + std::to_string((*known)[1]);
    if (!values.emplace(name, value).second)
    {
      throw InputError("Coefficients has " + name + " twice; give it once.");
    }
  }
  return values;
}

/// 1 for the cells where the array has the value.
std::vector<char> CellsOfRegion(vtkUnstructuredGrid* body, const std::string& name, double value)
{
  std::vector<char> chosen(static_cast<std::size_t>(body->GetNumberOfCells()), 1);
  if (name.empty() || name == "None")
  {
    return chosen;
  }
  vtkDataArray* array = body->GetCellData()->GetArray(name.c_str());
  if (!array || array->GetNumberOfComponents() != 1)
  {
    throw InputError("RegionArray is '" + name +
      "', but the body has no cell array of that name with one number a cell. Choose another, or "
      "None for the whole body.");
  }
  const double tolerance = RegionTolerance * std::abs(value);
  for (std::size_t cell = 0; cell < chosen.size(); ++cell)
  {
    const double here = array->GetComponent(static_cast<vtkIdType>(cell), 0);
    chosen[cell] = std::abs(here - value) <= tolerance;
  }
  if (std::find(chosen.begin(), chosen.end(), 1) == chosen.end())
  {
    double range[2];
    array->GetRange(range);
    std::ostringstream text;
    text << "RegionValue is " << value << ", but no cell has that value of " << name
         << "; its values lie between " << range[0] << " and " << range[1] << '.';
    throw InputError(text.str());
  }
  return chosen;
}

/// Value of the property Formulation: the one that suits the parameters.
constexpr int AutomaticFormulation = -1;

palpate::Material InFormulation(const palpate::Material& material, int number)
{
  switch (number)
  {
    case AutomaticFormulation:
      return material;
    case static_cast<int>(Formulation::displacement):
    case static_cast<int>(Formulation::mixed):
      break;
    default:
      throw InputError("Formulation is " + std::to_string(number) +
        "; there are -1 (Automatic), 0 (Displacement) and 1 (Mixed).");
  }
  const auto formulation = static_cast<Formulation>(number);
  try
  {
    return palpate::with_formulation(material, formulation);
  }
  catch (const InputError& error)
  {
    throw InputError(std::string("Formulation is '") +
      (formulation == Formulation::mixed ? "Mixed" : "Displacement") + "'. " + error.what() +
      " Choose Automatic.");
  }
}
}

vtkStandardNewMacro(vtkPalpateAssignMaterial);

int vtkPalpateAssignMaterial::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateAssignMaterial::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      const auto body =
        vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
      if (!body || vtkPalpatePassFailure(body, output))
      {
        return;
      }
      vtkPalpateElementOrder(body); // throws where the cells are not those of a body
      const palpate::Material material = InFormulation(this->MakeMaterial(), this->Formulation);
      const std::vector<char> chosen = CellsOfRegion(body, this->RegionArray, this->RegionValue);
      std::vector<char> others(chosen.size());
      std::transform(
        chosen.begin(), chosen.end(), others.begin(), [](char here) { return here == 0; });

      vtkPalpateMaterials materials = vtkPalpateReadMaterials(body, others);
      const auto added = static_cast<palpate::Index>(materials.Each.size());
      materials.Each.push_back(material);
      for (std::size_t cell = 0; cell < chosen.size(); ++cell)
      {
        if (chosen[cell] != 0)
        {
          materials.OfCell[cell] = added;
        }
      }
      output->ShallowCopy(body);
      vtkPalpateWriteMaterials(materials, output);
    });
  return 1;
}

palpate::Material vtkPalpateAssignMaterial::MakeMaterial() const
{
  const auto law = CheckedLaw(this->Law);
  std::map<std::string, double> values = { { "YoungsModulus", this->YoungsModulus },
    { "PoissonsRatio", this->PoissonsRatio }, { "C10", this->C10 }, { "C01", this->C01 },
    { "BulkModulus", this->BulkModulus }, { "Exponent", this->Exponent } };
  if (law == Law::mooney_rivlin_polynomial)
  {
    values = CoefficientsByName(this->Coefficients);
    values["BulkModulus"] = this->BulkModulus;
  }
  std::array<double, palpate::max_parameters> parameters{};
  std::size_t i = 0;
  for (const std::string& name : palpate::parameter_names(law))
  {
    parameters[i++] = values[name];
  }
  return palpate::make_material(law, parameters);
}

void vtkPalpateAssignMaterial::AddCoefficient(double r, double s, double value)
{
  this->Coefficients.push_back({ r, s, value });
  this->Modified();
}

void vtkPalpateAssignMaterial::ClearCoefficients()
{
  this->Coefficients.clear();
  this->Modified();
}

void vtkPalpateAssignMaterial::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Law: " << this->Law << '\n'
     << indent << "YoungsModulus: " << this->YoungsModulus << " Pa\n"
     << indent << "PoissonsRatio: " << this->PoissonsRatio << '\n'
     << indent << "C10: " << this->C10 << " Pa\n"
     << indent << "C01: " << this->C01 << " Pa\n"
     << indent << "BulkModulus: " << this->BulkModulus << " Pa\n"
     << indent << "Exponent: " << this->Exponent << '\n'
     << indent << "Formulation: " << this->Formulation << '\n'
     << indent << "RegionArray: " << this->RegionArray << '\n'
     << indent << "RegionValue: " << this->RegionValue << '\n';
  for (const auto& [r, s, value] : this->Coefficients)
  {
    os << indent << "Coefficient of the powers " << r << ' ' << s << ": " << value << " Pa\n";
  }
}
