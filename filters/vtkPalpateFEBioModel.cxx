// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioModel.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "base/error.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFEBioUnits.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateXMLTree.h"

namespace
{
using palpate::Formulation;
using palpate::Index;
using palpate::InputError;
using Tree = vtkPalpateXMLTree;

/// Of a node or an element in the file: any number, each once.
using Id = std::int64_t;

/// More nodes than an Index counts unknowns of.
constexpr Id MostOfRange = std::numeric_limits<Index>::max() / 3;

/// How an element of the file is called in a message.
std::string Label(const Tree& element)
{
  for (const char* name : { "name", "id", "type" })
  {
    if (const std::string* value = element.Attribute(name))
    {
      return '<' + element.Name + ' ' + name + "=\"" + *value + "\">";
    }
  }
  return '<' + element.Name + '>';
}

std::string Attribute(const Tree& element, const char* name)
{
  const std::string* value = element.Attribute(name);
  if (!value)
  {
    throw InputError(Label(element) + " has no attribute " + name + '.');
  }
  return *value;
}

/// @param text Numbers with a comma between them; ids also as ranges first:last or
/// first:last:step.
template <class Number>
void AppendNumbers(const std::string& text, const Tree& element, std::vector<Number>& numbers)
{
  const char* place = text.data();
  const char* const end = place + text.size();
  const auto skip = [&](const char* what)
  { place = std::find_if(place, end, [what](char c) { return !std::strchr(what, c); }); };
  const auto next = [&]
  {
    skip(" \t\r\n+");
    Number number{};
    const auto [behind, fault] = std::from_chars(place, end, number);
    if (fault != std::errc())
    {
      throw InputError(Label(element) + " has '" + text.substr(0, 40) +
        "' where numbers with a comma between them are due.");
    }
    place = behind;
    return number;
  };
  for (bool more = true; more;)
  {
    numbers.push_back(next());
    if constexpr (std::is_integral_v<Number>)
    {
      if (place != end && *place == ':')
      {
        const Number first = numbers.back();
        ++place;
        const Number last = next();
        Number step = 1;
        if (place != end && *place == ':')
        {
          ++place;
          step = std::max<Number>(next(), 1);
        }
        if (last - first > MostOfRange)
        {
          throw InputError(Label(element) + " has the range '" + text.substr(0, 40) +
            "', which is longer than any mesh.");
        }
        for (Number number = first + step; number <= last; number += step)
        {
          numbers.push_back(number);
        }
      }
    }
    skip(" \t\r\n");
    more = place != end && *place == ',';
    if (more)
    {
      ++place;
    }
    else if (place != end)
    {
      throw InputError(Label(element) + " has '" + text.substr(0, 40) +
        "' where numbers with a comma between them are due.");
    }
  }
}

double NumberOf(const std::string& text, const Tree& element)
{
  std::vector<double> numbers;
  AppendNumbers(text, element, numbers);
  if (numbers.size() != 1)
  {
    throw InputError(Label(element) + " has '" + text.substr(0, 40) + "' where one number is due.");
  }
  return numbers.front();
}

Id IdOf(const Tree& element, const char* attribute = "id")
{
  std::vector<Id> ids;
  AppendNumbers(Attribute(element, attribute), element, ids);
  return ids.front();
}

/// None where there is no such element.
const std::vector<Tree>& ChildrenOf(const Tree* element)
{
  static const std::vector<Tree> none;
  return element ? element->Children : none;
}

/// The ids of a set: those of the children (2.5, 3.0), or a list (4.0).
std::vector<Id> IdsOf(const Tree& set)
{
  std::vector<Id> ids;
  for (const Tree& child : set.Children)
  {
    ids.push_back(IdOf(child));
  }
  if (set.Children.empty() && !set.Text.empty())
  {
    AppendNumbers(set.Text, set, ids);
  }
  return ids;
}

bool StartsWith(const std::string& text, const char* start)
{
  return text.rfind(start, 0) == 0;
}

std::string Join(const std::vector<std::string>& words)
{
  std::string text;
  for (const std::string& word : words)
  {
    text += (text.empty() ? "" : ", ") + word;
  }
  return text;
}

/// Elements in the order of their ids.
std::vector<std::size_t> Order(const std::vector<Id>& ids, const char* what)
{
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(
    order.begin(), order.end(), [&ids](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
  const auto twice = std::adjacent_find(
    order.begin(), order.end(), [&ids](std::size_t a, std::size_t b) { return ids[a] == ids[b]; });
  if (twice != order.end())
  {
    throw InputError("There are two " + std::string(what) + " with the id " +
      std::to_string(ids[*twice]) + ". Give each an id of its own.");
  }
  return order;
}

/// A parameter of a material that varies from cell to cell.
using Map = std::unordered_map<Id, double>;

/// What a domain is made of.
struct DomainMaterial
{
  const vtkPalpateFEBioLaw* Law;
  std::optional<Formulation> OwnFormulation;
  std::array<double, palpate::max_parameters> Parameters{};
  std::vector<std::pair<const vtkPalpateFEBioLaw::Parameter*, const Map*>> Maps;
  std::string Name;
};

class Reader
{
public:
  Reader(const Tree& root, int units)
    : Root(root)
  {
    this->CheckVersion();
    this->ChooseUnits(units);
    for (const Tree& section : root.Children)
    {
      this->CheckSection(section);
    }
    this->Mesh = root.Child("Mesh") ? root.Child("Mesh") : root.Child("Geometry");
    if (!this->Mesh)
    {
      throw InputError("The file has no mesh: there is neither <Mesh> nor <Geometry> in it.");
    }
    for (const Tree& child : this->Mesh->Children)
    {
      if (child.Name == "Part" || child.Name == "Instance")
      {
        throw InputError("The mesh is made of copies of parts (<" + child.Name +
          ">), which are not read. Save the model with FEBio Studio, which writes the mesh "
          "itself.");
      }
    }
  }

  vtkPalpateFEBioModel Read()
  {
    this->ReadNodes();
    this->ReadElements();
    palpate::check_and_orient(this->Model.Scene.mesh);
    this->ReadBoundary();
    return std::move(this->Model);
  }

private:
  void CheckVersion()
  {
    if (this->Root.Name != "febio_spec")
    {
      throw InputError(
        "The file is not FEBio's: its root is <" + this->Root.Name + "> in place of <febio_spec>.");
    }
    const std::string version = Attribute(this->Root, "version");
    if (version != "2.5" && version != "3.0" && version != "4.0")
    {
      throw InputError("The file is of FEBio's specification " + version +
        "; 2.5, 3.0 and 4.0 are read. Open it with FEBio Studio and export it as 4.0.");
    }
    const Tree* module = this->Root.Child("Module");
    const std::string* type = module ? module->Attribute("type") : nullptr;
    if (type && *type != "solid")
    {
      throw InputError("The model is of FEBio's module '" + *type +
        "'; 'solid' is read, which has no fluids, no solutes and no heat.");
    }
  }

  void ChooseUnits(int units)
  {
    const auto& all = vtkPalpateFEBioUnits::All();
    if (units != vtkPalpateFEBioUnits::NotSaid &&
      (units < 0 || units >= static_cast<int>(all.size())))
    {
      throw InputError("Units is " + std::to_string(units) +
        "; there are -1 (In the File) and 0 to " + std::to_string(all.size() - 1) + " (" +
        vtkPalpateFEBioUnits::Names() + ").");
    }
    const Tree* module = this->Root.Child("Module");
    const Tree* said = module ? module->Child("units") : nullptr;
    if (said && !said->Text.empty())
    {
      this->Units = std::find_if(all.begin(), all.end(),
        [said](const vtkPalpateFEBioUnits& one) { return said->Text == one.Name; });
      if (this->Units == all.end())
      {
        throw InputError("The file says that its units are '" + said->Text +
          "', which is none of FEBio Studio's systems: " + vtkPalpateFEBioUnits::Names() + '.');
      }
      if (units != vtkPalpateFEBioUnits::NotSaid && this->Units != all.begin() + units)
      {
        throw InputError("Units is " + std::string(all[units].Name) +
          ", but the file says that its units are " + said->Text +
          ". Set Units to 'In the File', or mend the file.");
      }
      return;
    }
    if (units == vtkPalpateFEBioUnits::NotSaid)
    {
      throw InputError("The file does not say its units: there is no <units> in its <Module>. Set "
                       "Units to those in which the model was made (" +
        vtkPalpateFEBioUnits::Names() +
        "); with mm-N-s, for example, lengths are in mm and moduli in MPa.");
    }
    this->Units = all.begin() + units;
  }

  void CheckSection(const Tree& section)
  {
    const bool isElsewhere = section.Name == "Include" || section.Attribute("from");
    if (isElsewhere)
    {
      throw InputError(Label(section) +
        " stands in another file, which is not read. Put everything into one file.");
    }
    // What makes the body is read by its name; the others are about the computation.
    for (const char* name : { "Module", "Control", "Globals", "Material", "Mesh", "Geometry",
           "MeshDomains", "MeshData", "Boundary", "LoadData", "Output" })
    {
      if (section.Name == name)
      {
        return;
      }
    }
    if (section.Name == "Loads")
    {
      for (const Tree& load : section.Children)
      {
        this->LeaveOut(load);
      }
    }
    else if (section.Name == "Step")
    {
      this->CheckStep(section);
    }
    else if (!section.Children.empty())
    {
      throw InputError("The model has a section <" + section.Name +
        ">, which changes the body and is not read. Remove it from the model.");
    }
  }

  void CheckStep(const Tree& step)
  {
    for (const Tree& section : step.Children)
    {
      if (section.Name == "step")
      {
        this->CheckStep(section);
      }
      else if (section.Name == "Boundary")
      {
        for (const Tree& condition : section.Children)
        {
          if (!this->LeaveOutPrescribed(condition))
          {
            throw InputError(Label(condition) +
              " holds during a step alone. Assign it to the initial step of the model.");
          }
        }
      }
      else
      {
        this->CheckSection(section);
      }
    }
  }

  void LeaveOut(const Tree& what)
  {
    this->Model.Warnings.push_back(
      Label(what) + " acts on the body and is not part of it: it is left out.");
  }

  /// True where the condition moves points.
  bool LeaveOutPrescribed(const Tree& condition)
  {
    const std::string* type = condition.Attribute("type");
    const bool isPrescribed = StartsWith(condition.Name, "prescribe") ||
      (type && (StartsWith(*type, "prescribe") || *type == "normal displacement"));
    if (isPrescribed)
    {
      this->LeaveOut(condition);
    }
    return isPrescribed;
  }

  void ReadNodes()
  {
    std::vector<Id> ids;
    std::vector<double> coordinates;
    for (const Tree& nodes : this->Mesh->Children)
    {
      if (nodes.Name != "Nodes")
      {
        continue;
      }
      for (const Tree& node : nodes.Children)
      {
        ids.push_back(IdOf(node));
        AppendNumbers(node.Text, node, coordinates);
        if (coordinates.size() != 3 * ids.size())
        {
          throw InputError(Label(node) + " has '" + node.Text.substr(0, 40) +
            "' where three coordinates are due.");
        }
      }
    }
    this->IndexOfNode.reserve(ids.size());
    auto& points = this->Model.Scene.mesh.points;
    points.reserve(ids.size());
    for (const std::size_t place : Order(ids, "nodes"))
    {
      this->IndexOfNode[ids[place]] = static_cast<Index>(points.size());
      this->NodeIds.push_back(ids[place]);
      const double* x = &coordinates[3 * place];
      points.emplace_back(palpate::Vec3(x[0], x[1], x[2]) * this->Units->Length);
    }
  }

  Index IndexOf(Id node, const Tree& where) const
  {
    const auto found = this->IndexOfNode.find(node);
    if (found == this->IndexOfNode.end())
    {
      throw InputError(Label(where) + " has the node " + std::to_string(node) +
        ", which is not among the nodes of the file.");
    }
    return found->second;
  }

  static palpate::ElementOrder OrderOf(const Tree& elements)
  {
    const std::string type = Attribute(elements, "type");
    if (type == "tet4" || StartsWith(type, "TET4G"))
    {
      return palpate::ElementOrder::linear;
    }
    if (type == "tet10" || StartsWith(type, "TET10G"))
    {
      return palpate::ElementOrder::quadratic;
    }
    throw InputError(Label(elements) + " has elements of the type '" + type +
      "'; a body has tetrahedra alone (tet4 or tet10). Mesh it with tetrahedra.");
  }

  void ReadElements()
  {
    palpate::Scene& scene = this->Model.Scene;
    std::vector<Id> ids;
    std::vector<const Tree*> labels;
    std::vector<int> domains;
    std::vector<Id> nodes;
    std::vector<DomainMaterial> materials;
    std::optional<palpate::ElementOrder> order;
    for (const Tree& elements : this->Mesh->Children)
    {
      if (elements.Name != "Elements")
      {
        continue;
      }
      if (order.value_or(OrderOf(elements)) != OrderOf(elements))
      {
        throw InputError(Label(elements) + " has elements of the type '" +
          Attribute(elements, "type") +
          "', but others are before it: linear and quadratic tetrahedra cannot be mixed.");
      }
      order = OrderOf(elements);
      for (const Tree& element : elements.Children)
      {
        ids.push_back(IdOf(element));
        labels.push_back(&element);
        domains.push_back(static_cast<int>(materials.size()));
        AppendNumbers(element.Text, element, nodes);
        if (nodes.size() != ids.size() * palpate::nodes_per_cell(*order))
        {
          throw InputError(Label(element) + " has not the " +
            std::to_string(palpate::nodes_per_cell(*order)) + " nodes of a " +
            Attribute(elements, "type") + '.');
        }
      }
      materials.push_back(this->MaterialOf(elements));
      const std::string* name = elements.Attribute("name");
      this->Model.Regions.push_back(
        name ? *name : "Part" + std::to_string(this->Model.Regions.size() + 1));
    }
    if (ids.empty())
    {
      throw InputError("The file has no elements.");
    }

    scene.mesh.order = *order;
    const int nodesPerCell = palpate::nodes_per_cell(*order);
    // FEBio's order of the nodes is VTK's, midside nodes included: FETet10::shape_fnc.
    scene.mesh.cells.reserve(nodes.size());
    std::vector<Index> materialOfDomain(materials.size(), NoMaterial);
    for (const std::size_t place : Order(ids, "elements"))
    {
      for (int i = 0; i < nodesPerCell; ++i)
      {
        const Id node = nodes[place * nodesPerCell + i];
        scene.mesh.cells.push_back(this->IndexOf(node, *labels[place]));
      }
      const int domain = domains[place];
      this->Model.RegionOfCell.push_back(domain);
      const DomainMaterial& material = materials[domain];
      if (materialOfDomain[domain] == NoMaterial || !material.Maps.empty())
      {
        materialOfDomain[domain] = static_cast<Index>(scene.materials.size());
        scene.materials.push_back(MaterialOf(material, ids[place]));
      }
      scene.material_of_cell.push_back(materialOfDomain[domain]);
    }
  }

  /// That of one element.
  static palpate::Material MaterialOf(const DomainMaterial& domain, Id element)
  {
    auto parameters = domain.Parameters;
    for (const auto& [parameter, map] : domain.Maps)
    {
      const auto found = map->find(element);
      if (found == map->end())
      {
        throw InputError("The map of " + std::string(parameter->Name) + " of the material '" +
          domain.Name + "' has no value for the element " + std::to_string(element) + '.');
      }
      parameters[parameter->Index] = found->second;
    }
    if (domain.Law->Law == palpate::Law::ogden)
    {
      // A term that is not there has an exponent all the same in FEBio.
      for (int i = 1; i <= 2 * palpate::max_ogden_terms; i += 2)
      {
        parameters[i + 1] = parameters[i] == 0 ? 0 : parameters[i + 1];
      }
    }
    try
    {
      const palpate::Material material = palpate::make_material(domain.Law->Law, parameters);
      return domain.OwnFormulation ? palpate::with_formulation(material, *domain.OwnFormulation)
                                   : material;
    }
    catch (const InputError& error)
    {
      throw InputError("The material '" + domain.Name + "' of the element " +
        std::to_string(element) + ": " + error.what());
    }
  }

  /// The entry of <MeshDomains> (3.0, 4.0), or null (2.5).
  const Tree* DomainOf(const Tree& elements) const
  {
    const Tree* domains = this->Root.Child("MeshDomains");
    if (!domains)
    {
      return nullptr;
    }
    const std::string name = Attribute(elements, "name");
    for (const Tree& domain : domains->Children)
    {
      if (Attribute(domain, "name") == name)
      {
        if (domain.Name != "SolidDomain")
        {
          throw InputError(
            Label(domain) + " is a <" + domain.Name + ">; a body has solid domains alone.");
        }
        return &domain;
      }
    }
    throw InputError(Label(elements) + " has no material: there is no <SolidDomain name=\"" + name +
      "\"> in <MeshDomains>.");
  }

  DomainMaterial MaterialOf(const Tree& elements)
  {
    const Tree* domain = this->DomainOf(elements);
    const Tree& material = this->FindMaterial(Attribute(domain ? *domain : elements, "mat"));
    DomainMaterial read;
    read.Name = *material.Attribute(material.Attribute("name") ? "name" : "id");
    const std::string type = Attribute(material, "type");
    const auto& laws = vtkPalpateFEBioLaws();
    const auto law = std::find_if(laws.begin(), laws.end(),
      [&type](const vtkPalpateFEBioLaw& one) { return type == one.Type; });
    if (law == laws.end())
    {
      std::vector<std::string> types;
      for (const vtkPalpateFEBioLaw& one : laws)
      {
        types.emplace_back(one.Type);
      }
      throw InputError("The material '" + read.Name + "' is of FEBio's type '" + type +
        "', which is not read. There are: " + Join(types) + '.');
    }
    read.Law = &*law;
    this->ReadParameters(material, read);
    if (law->IsUncoupled && domain)
    {
      read.OwnFormulation = FormulationOf(*domain);
    }
    return read;
  }

  /// What the domain chooses where FEBio has a choice.
  static std::optional<Formulation> FormulationOf(const Tree& domain)
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

  /// By its name, or by its id (2.5).
  const Tree& FindMaterial(const std::string& reference) const
  {
    const Tree* materials = this->Root.Child("Material");
    for (const char* attribute : { "name", "id" })
    {
      for (const Tree& material : ChildrenOf(materials))
      {
        const std::string* value = material.Attribute(attribute);
        if (value && *value == reference)
        {
          return material;
        }
      }
    }
    throw InputError("There is no material '" + reference + "' in the file.");
  }

  void ReadParameters(const Tree& material, DomainMaterial& read)
  {
    const std::string where = "The material '" + read.Name + "' ";
    bool isOurPressure = !read.Law->IsUncoupled;
    for (const Tree& child : material.Children)
    {
      // At rest there is no inertia, and an isotropic material has no axes.
      if (child.Name == "density" || child.Name == "mat_axis")
      {
        continue;
      }
      if (child.Name == "pressure_model" && read.Law->IsUncoupled)
      {
        isOurPressure = child.Text == vtkPalpateFEBioPressureModel::Number ||
          child.Text == vtkPalpateFEBioPressureModel::Name;
        continue;
      }
      if (child.Attribute("lc"))
      {
        throw InputError(where + "has a parameter " + child.Name +
          " that follows a load curve; only constant ones are read.");
      }
      const auto known = std::find_if(read.Law->Parameters.begin(), read.Law->Parameters.end(),
        [&child](const auto& parameter) { return child.Name == parameter.Name; });
      if (known != read.Law->Parameters.end())
      {
        this->ReadParameter(child, *known, read);
        continue;
      }
      // An exponent of a term whose c is 0, which is checked itself.
      const bool isIdle = read.Law->Law == palpate::Law::ogden && child.Name[0] == 'm';
      // The tolerance of the augmentation, which is off where laugon is 0.
      const bool isTolerance = read.Law->IsUncoupled && child.Name == "atol";
      if (!isIdle && !isTolerance && (!child.Children.empty() || child.Text != "0") &&
        NumberOf(child.Text, child) != 0)
      {
        throw InputError(where + "has " + child.Name + " = " + child.Text + ", which our law " +
          palpate::to_string(read.Law->Law) + " does not have. It must be 0 or left out.");
      }
    }
    if (!isOurPressure)
    {
      throw InputError(where +
        "resists a change of volume by k/2 (ln J)^2 or another pressure_model, where ours has k/2 "
        "(J - 1)^2. Set its pressure_model to 2 ('Abaqus'), which is the same near J = 1.");
    }
  }

  void ReadParameter(
    const Tree& child, const vtkPalpateFEBioLaw::Parameter& parameter, DomainMaterial& read)
  {
    const std::string* type = child.Attribute("type");
    if (type && *type == "map")
    {
      read.Maps.emplace_back(&parameter, &this->FindMap(child.Text, parameter));
      return;
    }
    if (type && *type != "const")
    {
      throw InputError("The material '" + read.Name + "' has a parameter " + child.Name +
        " of the type '" + *type + "'; numbers and maps are read.");
    }
    read.Parameters[parameter.Index] = this->Ours(NumberOf(child.Text, child), parameter);
  }

  double Ours(double theirs, const vtkPalpateFEBioLaw::Parameter& parameter) const
  {
    return theirs / parameter.Factor * (parameter.IsPressure ? this->Units->Pressure : 1);
  }

  const Map& FindMap(const std::string& name, const vtkPalpateFEBioLaw::Parameter& parameter)
  {
    const std::string key = name + ' ' + parameter.Name;
    const auto [entry, isNew] = this->Maps.try_emplace(key);
    if (!isNew)
    {
      return entry->second;
    }
    const Tree* data = this->Root.Child("MeshData");
    bool isThere = false;
    for (const Tree& part : ChildrenOf(data))
    {
      const std::string* partName = part.Attribute("name");
      if (part.Name != "ElementData" || !partName || *partName != name)
      {
        continue;
      }
      isThere = true;
      this->ReadMap(part, parameter, entry->second);
    }
    if (!isThere)
    {
      throw InputError("There is no map '" + name + "' of elements in <MeshData>.");
    }
    return entry->second;
  }

  void ReadMap(const Tree& data, const vtkPalpateFEBioLaw::Parameter& parameter, Map& map) const
  {
    for (const char* attribute : { "data_type", "datatype" })
    {
      const std::string* type = data.Attribute(attribute);
      if (type && *type != "scalar")
      {
        throw InputError(Label(data) + " is of '" + *type + "'; numbers are read.");
      }
    }
    if (data.Attribute("type") || data.Attribute("generator"))
    {
      throw InputError(
        Label(data) + " is generated by FEBio; maps with a value for each element are read.");
    }
    const std::vector<Id> elements = this->ElementsOf(Attribute(data, "elem_set"), data);
    if (data.Children.empty())
    {
      const double value = this->Ours(NumberOf(data.Text, data), parameter);
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
      map[elements[place - 1]] = this->Ours(NumberOf(child.Text, child), parameter);
    }
  }

  /// Of a part or of a set.
  std::vector<Id> ElementsOf(const std::string& name, const Tree& where) const
  {
    for (const Tree& set : this->Mesh->Children)
    {
      const std::string* setName = set.Attribute("name");
      if ((set.Name == "Elements" || set.Name == "ElementSet") && setName && *setName == name)
      {
        return IdsOf(set);
      }
    }
    throw InputError(Label(where) + " is about the elements '" + name +
      "', but there is neither a part nor a set of that name.");
  }

  /// The nodes of a set, of a surface (@surface:), an edge (@edge:) or elements (@elem_set:).
  std::vector<Id> NodesOf(const std::string& reference, const Tree& where) const
  {
    std::string name = reference;
    const auto isSetOf = [&](const Tree& set, const char* prefix, const char* element)
    {
      const std::string* setName = set.Attribute("name");
      return setName && set.Name == element && prefix + *setName == name;
    };
    std::vector<Id> nodes;
    if (StartsWith(name, "@elem_set:"))
    {
      std::vector<Id> elements = this->ElementsOf(name.substr(name.find(':') + 1), where);
      std::sort(elements.begin(), elements.end());
      for (const Tree& part : this->Mesh->Children)
      {
        for (const Tree& element : ChildrenOf(part.Name == "Elements" ? &part : nullptr))
        {
          if (std::binary_search(elements.begin(), elements.end(), IdOf(element)))
          {
            AppendNumbers(element.Text, element, nodes);
          }
        }
      }
      return nodes;
    }
    for (const Tree& set : this->Mesh->Children)
    {
      if (isSetOf(set, "", "NodeSet") || isSetOf(set, "", "Nodes"))
      {
        return IdsOf(set);
      }
      if (isSetOf(set, "@surface:", "Surface") || isSetOf(set, "@edge:", "Edge"))
      {
        for (const Tree& face : set.Children)
        {
          AppendNumbers(face.Text, face, nodes);
        }
        return nodes;
      }
    }
    throw InputError(
      Label(where) + " is about the nodes '" + name + "', but there is no set of that name.");
  }

  /// 1, 2 and 4 for x, y and z, of those that a condition holds.
  static int AxesOf(const Tree& condition)
  {
    int axes = 0;
    const auto add = [&axes](const std::string& names)
    {
      std::string name;
      for (const char c : names + ',')
      {
        if (c != ',')
        {
          name += c == ' ' ? "" : std::string(1, c);
          continue;
        }
        // The others are of shells.
        axes |= name == "x" ? 1 : name == "y" ? 2 : name == "z" ? 4 : 0;
        name.clear();
      }
    };
    if (const std::string* names = condition.Attribute("bc")) // 2.5
    {
      add(*names);
    }
    if (const Tree* names = condition.Child("dofs")) // 3.0
    {
      add(names->Text);
    }
    for (const char* axis : { "x", "y", "z" }) // 4.0
    {
      const Tree* held = condition.Child((std::string(axis) + "_dof").c_str());
      if (held && held->Text == "1")
      {
        add(axis);
      }
    }
    return axes;
  }

  void ReadBoundary()
  {
    palpate::Scene& scene = this->Model.Scene;
    std::vector<char> axes(scene.mesh.points.size(), 0);
    const Tree* boundary = this->Root.Child("Boundary");
    for (const Tree& condition : ChildrenOf(boundary))
    {
      const std::string* type = condition.Attribute("type");
      const bool isFixed = condition.Name == "fix" ||
        (condition.Name == "bc" && type && (*type == "fix" || *type == "zero displacement"));
      // Degrees of freedom of shells and fluids, which a body does not have.
      const bool isOfOthers = type && StartsWith(*type, "zero ");
      if (isFixed)
      {
        const int held = AxesOf(condition);
        for (const Id node : this->NodesOf(Attribute(condition, "node_set"), condition))
        {
          axes[this->IndexOf(node, condition)] |= static_cast<char>(held);
        }
      }
      else if (!this->LeaveOutPrescribed(condition) && !isOfOthers)
      {
        throw InputError("The condition " + Label(condition) +
          " is not read: points are held along all three axes or free. Remove it from the model.");
      }
    }
    constexpr char allAxes = 7;
    const auto partly = std::find_if(
      axes.begin(), axes.end(), [](char held) { return held != 0 && held != allAxes; });
    if (partly != axes.end())
    {
      std::string names;
      for (const auto& [bit, name] : { std::pair(1, "x"), std::pair(2, "y"), std::pair(4, "z") })
      {
        names += (*partly & bit) == 0 ? "" : (names.empty() ? "" : " and ") + std::string(name);
      }
      throw InputError("The node " + std::to_string(this->NodeIds[partly - axes.begin()]) +
        " is held along " + names +
        " alone; points are held along all three axes or free. Hold it along all axes, or remove "
        "the condition from the model.");
    }
    scene.fixed.resize(axes.size());
    const std::vector<char> used = palpate::points_in_use(scene.mesh);
    std::transform(axes.begin(), axes.end(), used.begin(), scene.fixed.begin(),
      [](char held, char inUse) { return static_cast<char>(held == allAxes && inUse != 0); });
    if (std::find(scene.fixed.begin(), scene.fixed.end(), 1) == scene.fixed.end())
    {
      this->Model.Warnings.emplace_back(
        "The model holds no point of the body. Apply Set Boundary to it.");
    }
    this->ReadTouchable();
  }

  void ReadTouchable()
  {
    palpate::Scene& scene = this->Model.Scene;
    for (const Tree& set : this->Mesh->Children)
    {
      const std::string* name = set.Attribute("name");
      if (set.Name == "NodeSet" && name && *name == vtkPalpateArray::Touchable)
      {
        scene.touchable.assign(scene.mesh.points.size(), 0);
        for (const Id node : IdsOf(set))
        {
          scene.touchable[this->IndexOf(node, set)] = 1;
        }
        return;
      }
    }
    scene.touchable = vtkPalpateTouchableSurface(scene.mesh, scene.fixed);
  }

  static constexpr Index NoMaterial = -1;

  const Tree& Root;
  const Tree* Mesh = nullptr;
  const vtkPalpateFEBioUnits* Units = nullptr;
  /// In the order of the points, and back.
  std::vector<Id> NodeIds;
  std::unordered_map<Id, Index> IndexOfNode;
  /// By the name of the map and of the parameter.
  std::unordered_map<std::string, Map> Maps;
  vtkPalpateFEBioModel Model;
};
}

vtkPalpateFEBioModel vtkPalpateReadFEBio(const std::string& fileName, int units)
{
  const Tree root = vtkPalpateReadXML(fileName);
  try
  {
    return Reader(root, units).Read();
  }
  catch (const InputError& error)
  {
    throw InputError("The file " + fileName + " cannot be read. " + error.what());
  }
}
