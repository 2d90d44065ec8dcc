// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateAssignMaterial.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "base/error.h"
#include "base/join.h"
#include "materials/material.h"
#include "materials/rheology.h"
#include "materials/tissues.h"
#include "vtkFieldData.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateCellChoice.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPalpateWholeSurface.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVariant.h"

namespace
{
using palpate::Formulation;
using palpate::InputError;
using palpate::Law;

constexpr int FirstTissue = 100;

Law CheckedLaw(int number)
{
  if (number < 0 || number >= palpate::num_laws)
  {
    throw InputError("Law is " + std::to_string(number) + "; there are the laws 0 to " +
      std::to_string(palpate::num_laws - 1) + " and the tissues " + std::to_string(FirstTissue) +
      " to " + std::to_string(FirstTissue + palpate::tissues().size() - 1) + ".");
  }
  return static_cast<Law>(number);
}

/// The coefficients of rows r, s, C_rs, by the names of the parameters.
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

/// The names of the choices of the property Law: the laws, and from FirstTissue on the tissues.
std::vector<std::string> NamesOfLaws()
{
  std::vector<std::string> names;
  for (int number = 0; number < palpate::num_laws; ++number)
  {
    names.push_back(palpate::to_string(static_cast<Law>(number)));
  }
  return names;
}

/// The number that the whole text is.
double NumberOf(const std::string& text)
{
  bool isNumber = false;
  const double number = vtkVariant(text).ToDouble(&isNumber);
  if (!isNumber)
  {
    throw InputError('\'' + text + "' is not a number.");
  }
  return number;
}

/// The value of a region that is given by its number, or by a name of the body's labels.
double RegionOf(const std::string& text, vtkUnstructuredGrid* body)
{
  auto* names = vtkStringArray::SafeDownCast(body->GetFieldData()->GetAbstractArray("LabelName"));
  vtkDataArray* labels = body->GetFieldData()->GetArray("Label");
  bool isNumber = false;
  (void)vtkVariant(text).ToDouble(&isNumber);
  if (isNumber || !names || !labels || names->GetNumberOfValues() != labels->GetNumberOfTuples())
  {
    return NumberOf(text);
  }
  std::string there;
  for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
  {
    const std::string name = names->GetValue(i);
    if (name == text)
    {
      return labels->GetComponent(i, 0);
    }
    there += (there.empty() ? "'" : ", '") + name + '\'';
  }
  throw InputError("it is neither a number nor the name of a label. The body has: " + there + '.');
}

/// The values by name, from a text with names and values by turns.
std::map<std::string, double> NumbersByName(const std::string& text)
{
  std::map<std::string, double> values;
  std::istringstream words(text);
  for (std::string name, value; words >> name;)
  {
    if (!(words >> value))
    {
      throw InputError(name + " has no value.");
    }
    if (!values.emplace(name, NumberOf(value)).second)
    {
      throw InputError(name + " is given twice.");
    }
  }
  return values;
}

/// Takes the values of a rheology out of `values`; nothing if there are none.
std::optional<palpate::Rheology> TakeRheology(std::map<std::string, double>& values)
{
  palpate::RheologyValues own{};
  bool isOwn = false;
  for (int i = 0; i < palpate::num_rheology_values; ++i)
  {
    const auto found = values.find(palpate::rheology_names()[i]);
    if (found != values.end())
    {
      own[i] = found->second;
      isOwn = true;
      values.erase(found);
    }
  }
  return isOwn ? std::optional(palpate::make_rheology(own)) : std::nullopt;
}

palpate::Material MaterialOfLaw(Law law, const std::map<std::string, double>& values)
{
  const std::vector<std::string>& names = palpate::parameter_names(law);
  for (const auto& [name, value] : values)
  {
    if (std::find(names.begin(), names.end(), name) == names.end())
    {
      throw InputError("the law " + palpate::to_string(law) + " has no parameter '" + name +
        "'. It has: " + palpate::join(names) + "; and every law: " +
        palpate::join({ palpate::rheology_names().begin(), palpate::rheology_names().end() }) +
        '.');
    }
  }
  std::array<double, palpate::max_parameters> all{};
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    const auto found = values.find(names[i]);
    if (found != values.end())
    {
      all[i] = found->second;
    }
    // The laws of several terms need not have all of them.
    else if (law != Law::mooney_rivlin_polynomial && law != Law::ogden)
    {
      throw InputError("the law " + palpate::to_string(law) + " needs " + names[i] +
        ". Give names and values by turns, as 'YoungsModulus 5000 PoissonsRatio 0.45'.");
    }
  }
  return palpate::make_material(law, all);
}

/// @param name The name of a law, which has parameters, or of a tissue, which has none.
palpate::Material MaterialOfName(
  const std::string& name, const std::map<std::string, double>& parameters)
{
  for (const palpate::Tissue& tissue : palpate::tissues())
  {
    if (tissue.name == name)
    {
      if (!parameters.empty())
      {
        throw InputError("the tissue " + name + " has parameters of its own, but '" +
          parameters.begin()->first + "' is given. Leave them out, or name a law.");
      }
      return tissue.material;
    }
  }
  const std::vector<std::string> laws = NamesOfLaws();
  const auto law = std::find(laws.begin(), laws.end(), name);
  if (law == laws.end())
  {
    throw InputError("there is no law or tissue '" + name +
      "'. There are: " + palpate::join(vtkPalpateAssignMaterial::LawNames()) + '.');
  }
  return MaterialOfLaw(static_cast<Law>(law - laws.begin()), parameters);
}

/// That of the tissue of a name, J/m²; 0: it is not known, or the name is that of a law.
double ToughnessOf(const std::string& name)
{
  const auto& all = palpate::tissues();
  const auto tissue = std::find_if(
    all.begin(), all.end(), [&](const palpate::Tissue& each) { return each.name == name; });
  return tissue != all.end() ? tissue->toughness : 0;
}

/// Value of the property Formulation: the one that suits the parameters.
constexpr int AutomaticFormulation = -1;

/// Values of the property Quadrature.
constexpr int StandardQuadrature = 0;
constexpr int FineQuadrature = 1;

palpate::Material WithQuadrature(palpate::Material material, int number)
{
  if (number != StandardQuadrature && number != FineQuadrature)
  {
    throw InputError(
      "Quadrature is " + std::to_string(number) + "; there are 0 (Standard) and 1 (Fine).");
  }
  if (number == FineQuadrature && material.formulation == Formulation::mixed)
  {
    material.formulation = Formulation::mixed_fine;
  }
  return material;
}

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

struct vtkPalpateAssignMaterial::Assignment
{
  palpate::Material Material;
  /// The rheology; empty: the cells keep theirs.
  std::optional<palpate::Rheology> Rheology;
  std::vector<char> Cells;
  /// J/m²; 0: it is not known.
  double Toughness = 0;
};

vtkPalpateAssignMaterial::vtkPalpateAssignMaterial()
{
  this->SetNumberOfInputPorts(2);
}

vtkPalpateAssignMaterial::~vtkPalpateAssignMaterial() = default;

int vtkPalpateAssignMaterial::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

void vtkPalpateAssignMaterial::SetRegionShape(vtkImplicitFunction* shape)
{
  if (this->RegionShape != shape)
  {
    this->RegionShape = shape;
    this->Modified();
  }
}

vtkImplicitFunction* vtkPalpateAssignMaterial::GetRegionShape() const
{
  return this->RegionShape;
}

vtkMTimeType vtkPalpateAssignMaterial::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->RegionType == Shape && this->RegionShape
    ? std::max(own, this->RegionShape->GetMTime())
    : own;
}

int vtkPalpateAssignMaterial::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      // Every rank goes through the same calls of the controller, whatever happens on rank 0.
      vtkSmartPointer<vtkPolyData> surface;
      if (this->RegionType == Surface)
      {
        surface = vtkPalpateGatherSurface(vtkPalpateInput<vtkPolyData>(inputVector[1]), controller);
      }
      const auto gathered =
        vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
      if (!gathered || vtkPalpatePassFailure(gathered, output))
      {
        return;
      }
      const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(gathered);
      vtkUnstructuredGrid* body = cells.Body;
      // Throws where the cells are not those of a body.
      const palpate::ElementOrder order = vtkPalpateElementOrder(body);
      const std::vector<Assignment> assignments = this->Assignments(body, surface);
      std::vector<char> others(static_cast<std::size_t>(body->GetNumberOfCells()), 1);
      for (const Assignment& each : assignments)
      {
        std::transform(others.begin(), others.end(), each.Cells.begin(), others.begin(),
          [](char other, char here) { return other != 0 && here == 0; });
      }
      vtkPalpateMaterials materials = vtkPalpateReadMaterials(body, others);
      for (const Assignment& each : assignments)
      {
        const auto added = static_cast<palpate::Index>(materials.Each.size());
        materials.Each.push_back(each.Material);
        for (std::size_t cell = 0; cell < others.size(); ++cell)
        {
          if (each.Cells[cell] != 0)
          {
            materials.OfCell[cell] = added;
          }
        }
      }
      if (order == palpate::ElementOrder::linear &&
        std::any_of(assignments.begin(), assignments.end(),
          [](const Assignment& each) { return palpate::is_mixed(each.Material.formulation); }))
      {
        vtkWarningMacro(
          "The body has linear cells, and resists a change of volume through pressures (an "
          "incompressible law, or a PoissonsRatio above 0.45). Such cells do not lock, but are far "
          "too stiff in bending: a beam under its weight sinks by 35 % of what it should with one "
          "cube of them across its height, by 63 % with two, by 86 % with four. Take quadratic "
          "cells: ElementOrder Quadratic of the filter that makes the tetrahedra.");
      }
      output->ShallowCopy(body);
      vtkPalpateWriteMaterials(materials, output);
      for (const Assignment& each : assignments)
      {
        if (each.Rheology)
        {
          vtkPalpateAssignRheology(*each.Rheology, each.Cells, output);
        }
        vtkPalpateAssignToughness(each.Toughness, each.Cells, output);
      }
      if (!cells.LeftOut.empty())
      {
        vtkPalpateWarn(this, cells.LeftOut);
      }
    });
  return 1;
}

std::vector<char> vtkPalpateAssignMaterial::ChooseCells(
  vtkUnstructuredGrid* body, vtkPolyData* surface) const
{
  switch (this->RegionType)
  {
    case Array:
      return this->RegionArray.empty() || this->RegionArray == "None"
        ? std::vector<char>(static_cast<std::size_t>(body->GetNumberOfCells()), 1)
        : vtkPalpateCellsOfValue(body, this->RegionArray, this->RegionValue);
    case Shape:
      if (!this->RegionShape)
      {
        throw InputError("RegionType is 'Shape', but there is no RegionShape. Set one.");
      }
      return vtkPalpateCellsOfRegion(body, this->RegionShape);
    case Surface:
      if (!surface || surface->GetNumberOfCells() == 0)
      {
        throw InputError("RegionType is 'Surface', but the input Region Surface has no polygons. "
                         "Connect a closed surface to it.");
      }
      return vtkPalpateCellsOfSurface(body, surface);
    default:
      throw InputError("RegionType is " + std::to_string(this->RegionType) +
        "; there are 0 (Array), 1 (Shape), 2 (Surface) and 3 (Table).");
  }
}

palpate::Material vtkPalpateAssignMaterial::InItsFormulation(
  const palpate::Material& material) const
{
  return WithQuadrature(InFormulation(material, this->Formulation), this->Quadrature);
}

std::vector<vtkPalpateAssignMaterial::Assignment> vtkPalpateAssignMaterial::Assignments(
  vtkUnstructuredGrid* body, vtkPolyData* surface) const
{
  if (this->RegionType != Table)
  {
    const int tissue = this->Law - FirstTissue;
    return { { this->InItsFormulation(this->MakeMaterial()), this->MakeRheology(),
      this->ChooseCells(body, surface),
      tissue >= 0 ? palpate::tissues()[static_cast<std::size_t>(tissue)].toughness : 0 } };
  }
  if (this->Regions.empty())
  {
    throw InputError("RegionType is 'Table', but Regions is empty. Give it rows of a value of "
                     "RegionArray, a law and its parameters.");
  }
  if (this->RegionArray.empty() || this->RegionArray == "None")
  {
    throw InputError(
      "RegionType is 'Table', but there is no RegionArray. Choose the cell array that "
      "tells the regions apart.");
  }
  const std::optional<palpate::Rheology> rheology = this->MakeRheology();
  std::vector<Assignment> all;
  std::set<double> values;
  for (const auto& [value, law, parameters] : this->Regions)
  {
    try
    {
      const double number = RegionOf(value, body);
      if (!values.insert(number).second)
      {
        throw InputError("the value is there twice.");
      }
      std::map<std::string, double> numbers = NumbersByName(parameters);
      const std::optional<palpate::Rheology> own = TakeRheology(numbers);
      all.push_back({ this->InItsFormulation(MaterialOfName(law, numbers)), own ? own : rheology,
        vtkPalpateCellsOfValue(body, this->RegionArray, number), ToughnessOf(law) });
    }
    catch (const InputError& error)
    {
      throw InputError("Regions, value '" + value + "': " + error.what());
    }
  }
  return all;
}

palpate::Material vtkPalpateAssignMaterial::MakeMaterial() const
{
  const int tissue = this->Law - FirstTissue;
  if (tissue >= 0 && tissue < static_cast<int>(palpate::tissues().size()))
  {
    return palpate::tissues()[static_cast<std::size_t>(tissue)].material;
  }
  const auto law = CheckedLaw(this->Law);
  std::map<std::string, double> values = { { "YoungsModulus", this->YoungsModulus },
    { "PoissonsRatio", this->PoissonsRatio }, { "C10", this->C10 }, { "C01", this->C01 },
    { "BulkModulus", this->BulkModulus }, { "Exponent", this->Exponent } };
  if (law == Law::mooney_rivlin_polynomial)
  {
    values = CoefficientsByName(this->Coefficients);
    values["BulkModulus"] = this->BulkModulus;
  }
  for (int i = 0; i < palpate::max_ogden_terms; ++i)
  {
    values["OgdenModulus" + std::to_string(i + 1)] = this->OgdenModuli[i];
    values["OgdenExponent" + std::to_string(i + 1)] = this->OgdenExponents[i];
  }
  std::array<double, palpate::max_parameters> parameters{};
  std::size_t i = 0;
  for (const std::string& name : palpate::parameter_names(law))
  {
    parameters[i++] = values[name];
  }
  return palpate::make_material(law, parameters);
}

std::optional<palpate::Rheology> vtkPalpateAssignMaterial::MakeRheology() const
{
  const std::size_t terms = this->PronyModuli.size();
  if (terms != this->PronyTimes.size())
  {
    throw InputError("PronyModuli has " + std::to_string(terms) + " numbers, and PronyTimes has " +
      std::to_string(this->PronyTimes.size()) + ". Give one of each for every term.");
  }
  if (terms > palpate::max_prony_terms)
  {
    throw InputError("PronyModuli and PronyTimes have " + std::to_string(terms) +
      " terms; there may be " + std::to_string(palpate::max_prony_terms) + " at the most.");
  }
  palpate::Rheology rheology;
  rheology.density = this->Density;
  rheology.viscous_time = this->ViscousTime;
  for (std::size_t term = 0; term < terms; ++term)
  {
    // A term of the list must not be zero.
    if (this->PronyModuli[term] == 0 && this->PronyTimes[term] == 0)
    {
      throw InputError("Term " + std::to_string(term + 1) +
        " of PronyModuli and PronyTimes is 0. Give both numbers above 0, or leave it out.");
    }
    rheology.prony_moduli[term] = this->PronyModuli[term];
    rheology.prony_times[term] = this->PronyTimes[term];
  }
  palpate::validate(rheology);
  return rheology == palpate::Rheology() ? std::nullopt : std::optional(rheology);
}

std::vector<std::string> vtkPalpateAssignMaterial::LawNames()
{
  std::vector<std::string> names = NamesOfLaws();
  for (const palpate::Tissue& tissue : palpate::tissues())
  {
    names.push_back(tissue.name);
  }
  return names;
}

std::string vtkPalpateAssignMaterial::ParametersOfLaw(const std::string& name)
{
  const std::vector<std::string> laws = NamesOfLaws();
  const auto law = std::find(laws.begin(), laws.end(), name);
  if (law == laws.end())
  {
    return "";
  }
  vtkNew<vtkPalpateAssignMaterial> defaults;
  defaults->SetLaw(static_cast<int>(law - laws.begin()));
  const palpate::Material material = defaults->MakeMaterial();
  std::ostringstream text;
  const double* value = material.parameters.data();
  for (const std::string& parameter : palpate::parameter_names(material.law))
  {
    if (*value != 0)
    {
      text << (text.tellp() > 0 ? " " : "") << parameter << ' ' << *value;
    }
    ++value;
  }
  return text.str();
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

void vtkPalpateAssignMaterial::AddPronyModulus(double modulus)
{
  this->PronyModuli.push_back(modulus);
  this->Modified();
}

void vtkPalpateAssignMaterial::ClearPronyModuli()
{
  this->PronyModuli.clear();
  this->Modified();
}

void vtkPalpateAssignMaterial::AddPronyTime(double time)
{
  this->PronyTimes.push_back(time);
  this->Modified();
}

void vtkPalpateAssignMaterial::ClearPronyTimes()
{
  this->PronyTimes.clear();
  this->Modified();
}

void vtkPalpateAssignMaterial::AddRegion(const char* value, const char* law, const char* parameters)
{
  this->Regions.push_back({ value, law, parameters });
  this->Modified();
}

void vtkPalpateAssignMaterial::ClearRegions()
{
  this->Regions.clear();
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
     << indent << "OgdenModuli: " << this->OgdenModuli[0] << ' ' << this->OgdenModuli[1] << ' '
     << this->OgdenModuli[2] << " Pa\n"
     << indent << "OgdenExponents: " << this->OgdenExponents[0] << ' ' << this->OgdenExponents[1]
     << ' ' << this->OgdenExponents[2] << '\n'
     << indent << "Formulation: " << this->Formulation << '\n'
     << indent << "Quadrature: " << this->Quadrature << '\n'
     << indent << "Density: " << this->Density << " kg/m^3\n"
     << indent << "ViscousTime: " << this->ViscousTime << " s\n"
     << indent << "RegionType: " << this->RegionType << '\n'
     << indent << "RegionShape: " << this->RegionShape.Get() << '\n'
     << indent << "RegionArray: " << this->RegionArray << '\n'
     << indent << "RegionValue: " << this->RegionValue << '\n';
  const auto printList = [&](const char* name, const std::vector<double>& list)
  {
    os << indent << name << ':';
    for (const double number : list)
    {
      os << ' ' << number;
    }
    os << '\n';
  };
  printList("PronyModulus", this->PronyModuli);
  printList("PronyTime", this->PronyTimes);
  for (const auto& [r, s, value] : this->Coefficients)
  {
    os << indent << "Coefficient of the powers " << r << ' ' << s << ": " << value << " Pa\n";
  }
  for (const auto& [value, law, parameters] : this->Regions)
  {
    os << indent << "Region " << value << ": " << law << ' ' << parameters << '\n';
  }
}
