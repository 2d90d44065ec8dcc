// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioMaterials.h"

#include <algorithm>

#include "base/error.h"
#include "base/join.h"
#include "base/printable.h"
#include "base/quantity.h"

namespace
{
using namespace vtkPalpateFEBio;
using palpate::Formulation;
using palpate::InputError;
using palpate::printable;

constexpr const char* Viscoelastic = vtkPalpateFEBioLaw::Viscoelastic;
constexpr const char* UncoupledViscoelastic = vtkPalpateFEBioLaw::UncoupledViscoelastic;

std::string Subject(const std::string& material)
{
  return "The material '" + printable(material) + "' ";
}

/// The formulation that the domain chooses, if FEBio has a choice.
std::optional<Formulation> FormulationOf(const Tree& domain)
{
  const std::string* type = domain.Attribute("type");              // 4.0
  const std::string* threeField = domain.Attribute("three_field"); // 3.0
  if ((type && *type == "three-field-solid") || (threeField && *threeField == "on"))
  {
    return Formulation::mixed;
  }
  if ((type && *type == "elastic-solid") || (threeField && *threeField == "off"))
  {
    return Formulation::displacement;
  }
  return std::nullopt;
}

/// @throws InputError the value follows a load curve, a map or a formula.
void RequireConstant(const Tree& child, const std::string& where)
{
  const std::string* type = child.Attribute("type");
  if (child.Attribute("lc"))
  {
    throw InputError(where + "has a parameter " + printable(child.Name) +
      " that follows a load curve; only constant ones are read.");
  }
  if (type && *type != "const")
  {
    throw InputError(where + "has a parameter " + printable(child.Name) + " of the type '" +
      printable(*type) + "', which is not read for it. Make it one number.");
  }
}
}

/// g₀, and g_j and t_j of FEBio's six terms, with FEBio's defaults.
struct vtkPalpateFEBioMaterials::Series
{
  static constexpr int Size = 6;

  /// Reads the child if it is one of these parameters. @returns Whether it is.
  bool Take(const Tree& child, const std::string& where)
  {
    const std::string& name = child.Name;
    const int number = name.size() == 2 ? name[1] - '0' : -1;
    double* const value = name == "g0" ? &this->Whole
      : number < 1 || number > Size    ? nullptr
      : name[0] == 'g'                 ? &this->Moduli[number - 1]
      : name[0] == 't'                 ? &this->Times[number - 1]
                                       : nullptr;
    if (value)
    {
      RequireConstant(child, where);
      *value = NumberOf(child.Text, child);
    }
    return value != nullptr;
  }

  /// Gives a rheology the terms, in the order of their times, each time once.
  void Give(const std::string& where, palpate::Rheology& rheology) const
  {
    if (!(this->Whole > 0))
    {
      throw InputError(where + "has g0 = " + palpate::quantity(this->Whole) +
        "; what stays of the stress in the end must be positive.");
    }
    std::map<double, double> terms;
    bool isOrdered = true;
    for (int j = 0; j < Size; ++j)
    {
      if (this->Moduli[j] != 0)
      {
        isOrdered = isOrdered && j < palpate::max_prony_terms &&
          (terms.empty() || this->Times[j] > terms.rbegin()->first);
        terms[this->Times[j]] += this->Moduli[j] / this->Whole;
      }
    }
    if (terms.size() > palpate::max_prony_terms)
    {
      throw InputError(where + "has a Prony series of " + std::to_string(terms.size()) +
        " terms; there are " + std::to_string(palpate::max_prony_terms) +
        " here. Fit fewer terms to it.");
    }
    int place = 0;
    for (const auto& [time, modulus] : terms)
    {
      // A term that the file leaves free stays free.
      while (isOrdered && this->Moduli[place] == 0)
      {
        ++place;
      }
      rheology.prony_moduli[place] = modulus;
      rheology.prony_times[place] = time;
      ++place;
    }
  }

  double Whole = 1;
  std::array<double, Size> Moduli{};
  std::array<double, Size> Times{ 1, 1, 1, 1, 1, 1 };
};

vtkPalpateFEBioMaterials::vtkPalpateFEBioMaterials(const Tree& root, const ChildIndex& sets,
  const vtkPalpateFEBioUnits& units, const KnownIds& elements)
  : Root(root)
  , Sets(sets)
  , Domains(root.Child("MeshDomains"))
  , MaterialsByName(root.Child("Material"))
  , MaterialsById(root.Child("Material"), "id")
  , Data(root.Child("MeshData"))
  , Units(units)
  , Elements(elements)
{
  for (const Tree& domain : ChildrenOf(root.Child("MeshDomains")))
  {
    (void)Attribute(domain, "name");
  }
}

vtkPalpateFEBioMaterials::Part vtkPalpateFEBioMaterials::Of(const Tree& elements)
{
  const Tree* domain = this->DomainOf(elements);
  const Tree& material = this->Find(Attribute(domain ? *domain : elements, "mat"));
  const std::string type = Attribute(material, "type");
  const bool isViscous = type == Viscoelastic || type == UncoupledViscoelastic;
  Part part;
  part.Name = *material.Attribute(material.Attribute("name") ? "name" : "id");
  const std::string where = Subject(part.Name);

  const Tree* elastic = isViscous ? material.Child("elastic") : &material;
  if (!elastic)
  {
    throw InputError(where + "has no <elastic>, the law whose stress relaxes.");
  }
  this->ReadLaw(*elastic, part);
  this->ReadFormulation(domain, type, part);

  // The parameters of the material and of its law; the density is that of the material.
  std::vector<const Tree*> children;
  Series series;
  for (const Tree& child : material.Children)
  {
    if (!isViscous || (&child != elastic && !series.Take(child, where)))
    {
      children.push_back(&child);
    }
  }
  for (const Tree& child : ChildrenOf(isViscous ? elastic : nullptr))
  {
    if (child.Name != "density")
    {
      children.push_back(&child);
    }
  }
  if (isViscous)
  {
    series.Give(where, part.Rheology);
    part.VolumeIsViscous = type == Viscoelastic;
  }
  this->ReadParameters(children, series.Whole, part);
  const bool hasDensity = std::any_of(
    children.begin(), children.end(), [](const Tree* child) { return child->Name == "density"; });
  (hasDensity ? this->Heavy : this->Weightless).insert(part.Name);
  return part;
}

std::pair<palpate::Material, palpate::Rheology> vtkPalpateFEBioMaterials::Of(
  const Part& part, Id element)
{
  auto parameters = part.Parameters;
  palpate::Rheology rheology = part.Rheology;
  for (const auto& [index, map] : part.Maps)
  {
    const auto found = map->find(element);
    if (found == map->end())
    {
      throw InputError("A map of the material '" + printable(part.Name) +
        "' has no value for the element " + std::to_string(element) + '.');
    }
    (index == Part::Density ? rheology.density : parameters[index]) = found->second;
  }
  if (part.Law->Law == palpate::Law::ogden)
  {
    // In FEBio also a term that is not used has an exponent.
    for (int i = 1; i <= 2 * palpate::max_ogden_terms; i += 2)
    {
      parameters[i + 1] = parameters[i] == 0 ? 0 : parameters[i + 1];
    }
  }
  try
  {
    palpate::Material material = palpate::make_material(part.Law->Law, parameters);
    if (part.OwnFormulation)
    {
      material = palpate::with_formulation(material, *part.OwnFormulation);
    }
    palpate::validate(rheology);
    const bool isMixed = palpate::is_mixed(material.formulation);
    if (rheology.is_viscous() && part.VolumeIsViscous == isMixed)
    {
      this->Note(isMixed ? "is viscous in its change of volume too in FEBio, and elastic in it here"
                         : "changes its volume elastically in FEBio, and is viscous in it here",
        part);
    }
    return { material, rheology };
  }
  catch (const InputError& error)
  {
    throw InputError(
      Subject(part.Name) + "of the element " + std::to_string(element) + ": " + error.what());
  }
}

std::vector<std::string> vtkPalpateFEBioMaterials::Warnings() const
{
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& what, const std::set<std::string>& names)
  {
    const std::string all = printable(palpate::join({ names.begin(), names.end() }));
    warnings.push_back(
      (names.size() == 1 ? "The material " : "Each of the materials ") + all + ' ' + what + '.');
  };
  for (const auto& [what, names] : this->Notes)
  {
    warn(what, names);
  }
  if (!this->Heavy.empty() && !this->Weightless.empty())
  {
    warn("has no density, of which others have one: FEBio takes 1 in the units of the file, and "
         "here it is 0. Give it one",
      this->Weightless);
  }
  return warnings;
}

void vtkPalpateFEBioMaterials::Note(const std::string& what, const Part& part)
{
  this->Notes[what].insert(part.Name);
}

/// The entry of <MeshDomains> (3.0, 4.0), or null (2.5).
const vtkPalpateXMLTree* vtkPalpateFEBioMaterials::DomainOf(const Tree& elements) const
{
  if (!this->Root.Child("MeshDomains"))
  {
    return nullptr;
  }
  const std::string name = Attribute(elements, "name");
  if (const std::vector<const Tree*>* found = this->Domains.Find(name))
  {
    const Tree* domain = found->front();
    if (domain->Name != "SolidDomain")
    {
      throw InputError(Label(*domain) + " is a <" + printable(domain->Name) +
        ">; a body has solid domains alone.");
    }
    return domain;
  }
  throw InputError(Label(elements) + " has no material: there is no <SolidDomain name=\"" +
    printable(name) + "\"> in <MeshDomains>.");
}

/// Finds a material by its name, or by its id (2.5).
const vtkPalpateXMLTree& vtkPalpateFEBioMaterials::Find(const std::string& reference) const
{
  for (const ChildIndex* materials : { &this->MaterialsByName, &this->MaterialsById })
  {
    if (const std::vector<const Tree*>* found = materials->Find(reference))
    {
      return *found->front();
    }
  }
  throw InputError("There is no material '" + printable(reference) + "' in the file.");
}

void vtkPalpateFEBioMaterials::ReadLaw(const Tree& elastic, Part& part) const
{
  const std::string type = Attribute(elastic, "type");
  const auto& laws = vtkPalpateFEBioLaws();
  const auto law = std::find_if(
    laws.begin(), laws.end(), [&type](const vtkPalpateFEBioLaw& one) { return type == one.Type; });
  if (law == laws.end())
  {
    std::vector<std::string> types = { Viscoelastic, UncoupledViscoelastic };
    for (const vtkPalpateFEBioLaw& one : laws)
    {
      types.emplace_back(one.Type);
    }
    throw InputError(Subject(part.Name) + "is of FEBio's type '" + printable(type) +
      "', which is not read. There are: " + palpate::join(types) + '.');
  }
  part.Law = &*law;
}

void vtkPalpateFEBioMaterials::ReadFormulation(
  const Tree* domain, const std::string& type, Part& part) const
{
  if (type == UncoupledViscoelastic && !part.Law->IsUncoupled)
  {
    throw InputError(Subject(part.Name) + "is of the type '" + UncoupledViscoelastic +
      "', but its law '" + part.Law->Type + "' is not uncoupled. Use '" + Viscoelastic + "'.");
  }
  if (!part.Law->IsUncoupled)
  {
    return;
  }
  part.OwnFormulation = domain ? FormulationOf(*domain) : std::nullopt;
  // FEBio gives a pressure of their own to uncoupled materials alone.
  if (type == Viscoelastic)
  {
    if (part.OwnFormulation == Formulation::mixed)
    {
      throw InputError(Label(*domain) +
        " has a pressure of its own, which FEBio does not give to "
        "the type '" +
        Viscoelastic + "'. Use '" + UncoupledViscoelastic + "' for its material.");
    }
    part.OwnFormulation = Formulation::displacement;
  }
}

/// @param factor g₀.
void vtkPalpateFEBioMaterials::ReadParameters(
  const std::vector<const Tree*>& children, double factor, Part& part)
{
  const std::string where = Subject(part.Name);
  const std::vector<vtkPalpateFEBioLaw::Parameter>& known = part.Law->Parameters;
  const Tree* pressureModel = nullptr;
  std::set<std::string> names;
  for (const Tree* child : children)
  {
    const std::string& name = child->Name;
    if (!names.insert(name).second)
    {
      throw InputError(where + "has " + printable(name) + " twice. Say it once.");
    }
    // An isotropic material has no axes.
    if (name == "mat_axis")
    {
      continue;
    }
    if (name == "density")
    {
      this->ReadParameter(*child, Part::Density, this->Units.Density, part);
      continue;
    }
    if (name == "pressure_model" && part.Law->IsUncoupled)
    {
      pressureModel = child;
      continue;
    }
    const auto found = std::find_if(known.begin(), known.end(),
      [&name](const auto& parameter) { return name == parameter.Name; });
    if (found != known.end())
    {
      // The elastic change of volume of an uncoupled material does not relax.
      const bool relaxes = part.VolumeIsViscous.value_or(false) || name != "k";
      const double unit = found->IsPressure ? this->Units.Pressure * (relaxes ? factor : 1) : 1;
      this->ReadParameter(*child, found->Index, unit / found->Factor, part);
      continue;
    }
    // An exponent of a term whose c is 0, which is checked itself.
    const bool isIdle = part.Law->Law == palpate::Law::ogden && name[0] == 'm';
    // The tolerance of the augmentation, which is off where laugon is 0.
    const bool isTolerance = part.Law->IsUncoupled && name == "atol";
    if (!isIdle && !isTolerance && (!child->Children.empty() || NumberOf(child->Text, *child) != 0))
    {
      throw InputError(where + "has " + printable(name) + " = " + printable(child->Text) +
        ", which our law " + palpate::to_string(part.Law->Law) +
        " does not have. It must be 0 or left out.");
    }
  }
  if (part.Law->IsUncoupled)
  {
    this->ReadPressureModel(pressureModel, part);
  }
}

/// @param choice The element with the choice; null: the first model is taken.
void vtkPalpateFEBioMaterials::ReadPressureModel(const Tree* choice, const Part& part)
{
  const auto& all = vtkPalpateFEBioPressureModel::All();
  const auto model = !choice
    ? all.begin()
    : std::find_if(all.begin(), all.end(),
        [choice](const vtkPalpateFEBioPressureModel& one)
        { return choice->Text == one.Number || choice->Text == one.Name; });
  if (model == all.end())
  {
    throw InputError(Subject(part.Name) + "has the pressure_model '" + printable(choice->Text) +
      "', which FEBio does not have. There are 0 (default) to 3.");
  }
  if (model->Difference != 0)
  {
    this->Note("resists a change of volume by " + std::string(model->Energy) + " (pressure_model " +
        model->Name +
        "), which is read as k/2 (J - 1)^2: where the volume has changed by 1 %, the pressure "
        "differs by " +
        palpate::quantity(model->Difference) + " %",
      part);
  }
}

/// @param index The index of the parameter, or Part::Density.
/// @param unit The factor of FEBio's number.
void vtkPalpateFEBioMaterials::ReadParameter(const Tree& child, int index, double unit, Part& part)
{
  const std::string* type = child.Attribute("type");
  if (type && *type == "map" && !child.Attribute("lc"))
  {
    part.Maps.emplace_back(index, &this->FindMap(child.Text, unit));
    return;
  }
  RequireConstant(child, Subject(part.Name));
  (index == Part::Density ? part.Rheology.density : part.Parameters[index]) =
    NumberOf(child.Text, child) * unit;
}

const vtkPalpateFEBioMaterials::Map& vtkPalpateFEBioMaterials::FindMap(
  const std::string& name, double unit)
{
  const auto [entry, isNew] = this->Maps.try_emplace({ name, unit });
  if (!isNew)
  {
    return entry->second;
  }
  bool isThere = false;
  const std::vector<const Tree*>* found = this->Data.Find(name);
  for (const Tree* data : found ? *found : std::vector<const Tree*>())
  {
    if (data->Name == "ElementData")
    {
      isThere = true;
      this->ReadMap(*data, unit, entry->second);
    }
  }
  if (!isThere)
  {
    throw InputError("There is no map '" + printable(name) + "' of elements in <MeshData>.");
  }
  return entry->second;
}

void vtkPalpateFEBioMaterials::ReadMap(const Tree& data, double unit, Map& map) const
{
  for (const char* attribute : { "data_type", "datatype" })
  {
    const std::string* type = data.Attribute(attribute);
    if (type && *type != "scalar")
    {
      throw InputError(Label(data) + " is of '" + printable(*type) + "'; numbers are read.");
    }
  }
  if (data.Attribute("type") || data.Attribute("generator"))
  {
    throw InputError(
      Label(data) + " is generated by FEBio; maps with a value for each element are read.");
  }
  const std::vector<Id> elements =
    ElementsOf(this->Sets, Attribute(data, "elem_set"), data, this->Elements);
  if (data.Children.empty())
  {
    const double value = NumberOf(data.Text, data) * unit;
    for (const Id element : elements)
    {
      map[element] = value;
    }
  }
  for (const Tree& child : data.Children)
  {
    const Id place = IdOf(child, "lid");
    if (place < 1 || place > static_cast<Id>(elements.size()))
    {
      throw InputError(Label(data) + " has a value for the element " + std::to_string(place) +
        " of " + std::to_string(elements.size()) + '.');
    }
    map[elements[place - 1]] = NumberOf(child.Text, child) * unit;
  }
}
