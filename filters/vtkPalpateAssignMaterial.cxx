// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateAssignMaterial.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "base/error.h"
#include "materials/material.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::InputError;
using palpate::Law;

/// Values of a region array are told apart by more than this share: an array in single precision
/// holds 0.1 only to 1e-8.
constexpr double RegionTolerance = 1e-6;

/// A cell array of parameters.
struct Column
{
  const char* Name;
  std::size_t Parameter; ///< which of palpate::Material::parameters it is
  bool MooneyRivlin;     ///< whether Mooney-Rivlin is the law that uses it
};

constexpr Column Columns[] = { { vtkPalpateArray::YoungsModulus, 0, false },
  { vtkPalpateArray::PoissonsRatio, 1, false }, { vtkPalpateArray::C10, 0, true },
  { vtkPalpateArray::C01, 1, true }, { vtkPalpateArray::BulkModulus, 2, true } };

Law CheckedLaw(int number)
{
  if (number < 0 || number >= palpate::num_laws)
  {
    throw InputError("Law is " + std::to_string(number) + "; there are the laws 0 to " +
      std::to_string(palpate::num_laws - 1) + ".");
  }
  return static_cast<Law>(number);
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

/// A copy of the cell array, or one filled with `background` where there is none.
template <class Array>
vtkSmartPointer<Array> CopyOrMake(
  vtkUnstructuredGrid* body, const char* name, typename Array::ValueType background)
{
  auto copy = vtkSmartPointer<Array>::New();
  vtkDataArray* array = body->GetCellData()->GetArray(name);
  if (array && array->GetNumberOfComponents() == 1)
  {
    copy->DeepCopy(array);
  }
  else
  {
    copy->SetNumberOfValues(body->GetNumberOfCells());
    copy->FillValue(background);
  }
  copy->SetName(name);
  return copy;
}

template <class Array>
void SetWhere(const std::vector<char>& chosen, typename Array::ValueType value, Array* array)
{
  for (std::size_t cell = 0; cell < chosen.size(); ++cell)
  {
    if (chosen[cell] != 0)
    {
      array->SetValue(static_cast<vtkIdType>(cell), value);
    }
  }
}
}

vtkStandardNewMacro(vtkPalpateAssignMaterial);

int vtkPalpateAssignMaterial::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  return vtkPalpateProduce(this, output,
    [&]
    {
      const auto body = vtkPalpateGatherBody(vtkUnstructuredGrid::GetData(inputVector[0]),
        vtkMultiProcessController::GetGlobalController());
      if (!body || vtkPalpatePassFailure(body, output))
      {
        return;
      }
      vtkPalpateElementOrder(body); // throws where the cells are not those of a body
      const auto law = CheckedLaw(this->Law);
      const bool mooneyRivlin = law == Law::mooney_rivlin;
      const palpate::Material material = mooneyRivlin
        ? palpate::make_mooney_rivlin(this->C10, this->C01, this->BulkModulus)
        : palpate::make_isotropic(law, this->YoungsModulus, this->PoissonsRatio);
      const std::vector<char> chosen = CellsOfRegion(body, this->RegionArray, this->RegionValue);

      output->ShallowCopy(body);
      const auto laws = CopyOrMake<vtkIntArray>(body, vtkPalpateArray::Law, vtkPalpateNoLaw);
      SetWhere(chosen, this->Law, laws.Get());
      output->GetCellData()->AddArray(laws);

      const int* first = laws->GetPointer(0);
      const int* last = first + laws->GetNumberOfValues();
      const bool needsMooneyRivlin =
        std::find(first, last, static_cast<int>(Law::mooney_rivlin)) != last;
      const bool needsIsotropic = std::any_of(first, last,
        [](int number)
        { return number != vtkPalpateNoLaw && number != static_cast<int>(Law::mooney_rivlin); });
      for (const Column& column : Columns)
      {
        if (!(column.MooneyRivlin ? needsMooneyRivlin : needsIsotropic))
        {
          output->GetCellData()->RemoveArray(column.Name);
          continue;
        }
        const auto array = CopyOrMake<vtkDoubleArray>(body, column.Name, 0);
        SetWhere(chosen,
          column.MooneyRivlin == mooneyRivlin ? material.parameters[column.Parameter] : 0,
          array.Get());
        output->GetCellData()->AddArray(array);
      }
    });
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
     << indent << "RegionArray: " << this->RegionArray << '\n'
     << indent << "RegionValue: " << this->RegionValue << '\n';
}
