// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateMaterials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Formulation;
using palpate::Index;
using palpate::InputError;
using palpate::Law;
using palpate::Material;

constexpr int NoLaw = -1;

/// The number in the array as an enumeration of `count` values.
int EnumeratorIn(vtkDataArray* array, vtkIdType cell, int count)
{
  const double number = array->GetComponent(cell, 0);
  for (int value = 0; value < count; ++value)
  {
    if (number == value)
    {
      return value;
    }
  }
  std::ostringstream text;
  text << "Cell " << cell << " has " << array->GetName() << ' ' << number
       << "; there are the numbers 0 to " << count - 1 << ". Apply Assign Material to the body.";
  throw InputError(text.str());
}

/// The materials of a body, cell by cell.
class Reader
{
public:
  explicit Reader(vtkUnstructuredGrid* body)
    : Laws(vtkPalpateScalarArray(body->GetCellData(), vtkPalpateArray::Law))
    , Formulations(vtkPalpateScalarArray(body->GetCellData(), vtkPalpateArray::Formulation))
  {
    for (int law = 0; law < palpate::num_laws; ++law)
    {
      for (const std::string& name : palpate::parameter_names(static_cast<Law>(law)))
      {
        this->Parameters[law].push_back(
          { name, vtkPalpateScalarArray(body->GetCellData(), name.c_str()) });
      }
    }
  }

  bool HasMaterial(vtkIdType cell) const
  {
    return this->Laws && this->Laws->GetComponent(cell, 0) != NoLaw;
  }

  Material Read(vtkIdType cell) const
  {
    const int law = EnumeratorIn(this->Laws, cell, palpate::num_laws);
    const int formulation =
      this->Formulations ? EnumeratorIn(this->Formulations, cell, palpate::num_formulations) : 0;
    try
    {
      std::array<double, palpate::max_parameters> values{};
      std::size_t i = 0;
      for (const Parameter& parameter : this->Parameters[law])
      {
        if (!parameter.Array)
        {
          throw InputError("its law needs the cell array " + parameter.Name +
            ", which is missing. Apply Assign Material to the body.");
        }
        values[i++] = parameter.Array->GetComponent(cell, 0);
      }
      const Material material = palpate::make_material(static_cast<Law>(law), values);
      return this->Formulations
        ? palpate::with_formulation(material, static_cast<Formulation>(formulation))
        : material;
    }
    catch (const InputError& error)
    {
      throw InputError("Material of cell " + std::to_string(cell) + ": " + error.what());
    }
  }

private:
  struct Parameter
  {
    std::string Name;
    vtkDataArray* Array;
  };

  vtkDataArray* Laws;
  vtkDataArray* Formulations;
  std::array<std::vector<Parameter>, palpate::num_laws> Parameters;
};

bool HasSuitableFormulation(const Material& material)
{
  return palpate::make_material(material.law, material.parameters) == material;
}

template <class Array>
void Replace(vtkUnstructuredGrid* body, const std::string& name, const vtkPalpateMaterials& all,
  typename Array::ValueType none, const std::vector<typename Array::ValueType>& values)
{
  vtkNew<Array> array;
  array->SetName(name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(all.OfCell.size()));
  for (std::size_t cell = 0; cell < all.OfCell.size(); ++cell)
  {
    const Index material = all.OfCell[cell];
    array->SetValue(static_cast<vtkIdType>(cell),
      material == vtkPalpateMaterials::None ? none : values[material]);
  }
  body->GetCellData()->AddArray(array);
}

/// Gives the cells that are `wanted` a value of an array; the others keep theirs. An array that is
/// 0 throughout afterwards is removed.
void AssignValue(
  const std::string& name, double value, const std::vector<char>& wanted, vtkUnstructuredGrid* body)
{
  vtkDataArray* before = vtkPalpateScalarArray(body->GetCellData(), name.c_str());
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(wanted.size()));
  bool isThere = false;
  for (std::size_t cell = 0; cell < wanted.size(); ++cell)
  {
    const auto id = static_cast<vtkIdType>(cell);
    const double kept = before ? before->GetComponent(id, 0) : 0;
    array->SetValue(id, wanted[cell] != 0 ? value : kept);
    isThere = isThere || array->GetValue(id) != 0;
  }
  body->GetCellData()->RemoveArray(name.c_str());
  if (isThere)
  {
    body->GetCellData()->AddArray(array);
  }
}
}

vtkPalpateMaterials vtkPalpateReadMaterials(
  vtkUnstructuredGrid* body, const std::vector<char>& wanted)
{
  const Reader reader(body);
  vtkPalpateMaterials all;
  std::map<std::tuple<Law, Formulation, std::array<double, palpate::max_parameters>>, Index>
    indices;
  all.OfCell.assign(wanted.size(), vtkPalpateMaterials::None);
  for (std::size_t cell = 0; cell < wanted.size(); ++cell)
  {
    if (wanted[cell] == 0 || !reader.HasMaterial(static_cast<vtkIdType>(cell)))
    {
      continue;
    }
    const Material material = reader.Read(static_cast<vtkIdType>(cell));
    const auto [found, isNew] =
      indices.try_emplace({ material.law, material.formulation, material.parameters },
        static_cast<Index>(all.Each.size()));
    if (isNew)
    {
      all.Each.push_back(material);
    }
    all.OfCell[cell] = found->second;
  }
  return all;
}

void vtkPalpateWriteMaterials(const vtkPalpateMaterials& materials, vtkUnstructuredGrid* body)
{
  std::vector<int> laws;
  std::vector<int> formulations;
  std::map<std::string, std::vector<double>> columns;
  for (std::size_t m = 0; m < materials.Each.size(); ++m)
  {
    const Material& material = materials.Each[m];
    laws.push_back(static_cast<int>(material.law));
    formulations.push_back(static_cast<int>(material.formulation));
    const double* value = material.parameters.data();
    for (const std::string& name : palpate::parameter_names(material.law))
    {
      std::vector<double>& column = columns[name];
      column.resize(materials.Each.size(), 0);
      column[m] = *value++;
    }
  }

  Replace<vtkIntArray>(body, vtkPalpateArray::Law, materials, NoLaw, laws);
  for (int law = 0; law < palpate::num_laws; ++law)
  {
    for (const std::string& name : palpate::parameter_names(static_cast<Law>(law)))
    {
      body->GetCellData()->RemoveArray(name.c_str());
    }
  }
  for (const auto& [name, values] : columns)
  {
    Replace<vtkDoubleArray>(body, name, materials, 0, values);
  }
  if (std::all_of(materials.Each.begin(), materials.Each.end(), HasSuitableFormulation))
  {
    body->GetCellData()->RemoveArray(vtkPalpateArray::Formulation);
  }
  else
  {
    Replace<vtkIntArray>(body, vtkPalpateArray::Formulation, materials, 0, formulations);
  }
}

void vtkPalpateAssignRheology(
  const palpate::Rheology& rheology, const std::vector<char>& wanted, vtkUnstructuredGrid* body)
{
  const palpate::RheologyValues values = palpate::values_of(rheology);
  for (int i = 0; i < palpate::num_rheology_values; ++i)
  {
    AssignValue(palpate::rheology_names()[i], values[i], wanted, body);
  }
}

void vtkPalpateAssignToughness(
  double toughness, const std::vector<char>& wanted, vtkUnstructuredGrid* body)
{
  AssignValue(vtkPalpateArray::FractureToughness, toughness, wanted, body);
}

void vtkPalpateWriteRheologies(const std::vector<palpate::Rheology>& rheologies,
  const std::vector<Index>& rheologyOfCell, vtkUnstructuredGrid* body)
{
  std::vector<palpate::RheologyValues> values;
  values.reserve(rheologies.size());
  for (const palpate::Rheology& rheology : rheologies)
  {
    values.push_back(palpate::values_of(rheology));
  }
  for (int i = 0; i < palpate::num_rheology_values; ++i)
  {
    if (std::all_of(values.begin(), values.end(), [i](const auto& of) { return of[i] == 0; }))
    {
      continue;
    }
    vtkNew<vtkDoubleArray> array;
    array->SetName(palpate::rheology_names()[i].c_str());
    array->SetNumberOfValues(static_cast<vtkIdType>(rheologyOfCell.size()));
    for (std::size_t cell = 0; cell < rheologyOfCell.size(); ++cell)
    {
      array->SetValue(static_cast<vtkIdType>(cell), values[rheologyOfCell[cell]][i]);
    }
    body->GetCellData()->AddArray(array);
  }
}

std::vector<palpate::Rheology> vtkPalpateReadRheologies(
  vtkUnstructuredGrid* body, vtkPalpateMaterials& materials)
{
  std::array<vtkDataArray*, palpate::num_rheology_values> arrays{};
  for (int i = 0; i < palpate::num_rheology_values; ++i)
  {
    arrays[i] = vtkPalpateScalarArray(body->GetCellData(), palpate::rheology_names()[i].c_str());
  }
  std::map<std::pair<Index, palpate::RheologyValues>, Index> indices;
  std::vector<palpate::Rheology> rheologies;
  std::vector<Material> each;
  for (std::size_t cell = 0; cell < materials.OfCell.size(); ++cell)
  {
    palpate::RheologyValues values{};
    for (int i = 0; i < palpate::num_rheology_values; ++i)
    {
      values[i] = arrays[i] ? arrays[i]->GetComponent(static_cast<vtkIdType>(cell), 0) : 0;
    }
    // NaN has no place in an order.
    const bool isNumber =
      std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
    const auto known = isNumber ? indices.find({ materials.OfCell[cell], values }) : indices.end();
    if (known != indices.end())
    {
      materials.OfCell[cell] = known->second;
      continue;
    }
    try
    {
      rheologies.push_back(palpate::make_rheology(values));
    }
    catch (const InputError& error)
    {
      throw InputError("Material of cell " + std::to_string(cell) + ": " + error.what());
    }
    const auto added = static_cast<Index>(each.size());
    each.push_back(materials.Each[materials.OfCell[cell]]);
    indices.emplace(std::pair(materials.OfCell[cell], values), added);
    materials.OfCell[cell] = added;
  }
  materials.Each = std::move(each);
  return rheologies;
}
