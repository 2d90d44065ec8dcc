// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioModel.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/printable.h"
#include "vtkPalpateFEBioMaterials.h"
#include "vtkPalpateFEBioModelReader.h"

namespace vtkPalpateFEBio
{
using palpate::Index;
using palpate::InputError;
using palpate::printable;

namespace
{
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
}

ModelReader::ModelReader(const Tree& root, int units)
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
  this->Sets = ChildIndex(this->Mesh);
}

vtkPalpateFEBioModel ModelReader::Read()
{
  this->ReadNodes();
  this->ReadElements();
  palpate::check_and_orient(this->Model.Scene.body.mesh);
  this->ReadLoads();
  this->ReadBoundary();
  return std::move(this->Model);
}

void ModelReader::CheckVersion()
{
  if (this->Root.Name != "febio_spec")
  {
    throw InputError("The file is not FEBio's: its root is <" + printable(this->Root.Name) +
      "> in place of <febio_spec>.");
  }
  const std::string version = Attribute(this->Root, "version");
  if (version != "2.5" && version != "3.0" && version != "4.0")
  {
    throw InputError("The file is of FEBio's specification " + printable(version) +
      "; 2.5, 3.0 and 4.0 are read. Open it with FEBio Studio and export it as 4.0.");
  }
  const Tree* module = this->Root.Child("Module");
  const std::string* type = module ? module->Attribute("type") : nullptr;
  if (type && *type != "solid")
  {
    throw InputError("The model is of FEBio's module '" + printable(*type) +
      "'; 'solid' is read, which has no fluids, no solutes and no heat.");
  }
}

void ModelReader::ChooseUnits(int units)
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
      throw InputError("The file says that its units are '" + printable(said->Text) +
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

void ModelReader::CheckSection(const Tree& section)
{
  const bool isElsewhere = section.Name == "Include" || section.Attribute("from");
  if (isElsewhere)
  {
    throw InputError(
      Label(section) + " stands in another file, which is not read. Put everything into one file.");
  }
  // These sections describe the body, and are read by their names. The others are about the
  // computation.
  for (const char* name : { "Module", "Control", "Globals", "Material", "Mesh", "Geometry",
         "MeshDomains", "MeshData", "Boundary", "Loads", "LoadData", "Output" })
  {
    if (section.Name == name)
    {
      return;
    }
  }
  if (section.Name == "Constraints")
  {
    this->CheckConstraints(section);
  }
  else if (section.Name == "Step")
  {
    this->CheckStep(section);
  }
  else if (!section.Children.empty())
  {
    throw InputError("The model has a section <" + printable(section.Name) +
      ">, which changes the body and is not read. Remove it from the model.");
  }
}

void ModelReader::CheckConstraints(const Tree& section) const
{
  for (const Tree& constraint : section.Children)
  {
    if (Attribute(constraint, "type") != SymmetryPlane)
    {
      throw InputError("The constraint " + Label(constraint) +
        " is not read, but for a symmetry plane. Remove it from the model.");
    }
  }
}

void ModelReader::CheckStep(const Tree& step)
{
  for (const Tree& section : step.Children)
  {
    if (section.Name == "step")
    {
      this->CheckStep(section);
    }
    else if (section.Name == "Loads")
    {
      for (const Tree& load : section.Children)
      {
        this->LeaveOut(load);
      }
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

void ModelReader::LeaveOut(const Tree& what)
{
  this->Model.Warnings.push_back(
    Label(what) + " acts on the body and is not part of it: it is left out.");
}

bool ModelReader::LeaveOutPrescribed(const Tree& condition)
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

void ModelReader::ReadNodes()
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
        throw InputError(
          Label(node) + " has '" + printable(node.Text) + "' where three coordinates are due.");
      }
    }
  }
  this->IndexOfNode.reserve(ids.size());
  auto& points = this->Model.Scene.body.mesh.points;
  points.reserve(ids.size());
  for (const std::size_t place : Order(ids, "nodes"))
  {
    this->IndexOfNode[ids[place]] = static_cast<Index>(points.size());
    this->Nodes.Ids.push_back(ids[place]);
    const double* x = &coordinates[3 * place];
    points.emplace_back(palpate::Vec3(x[0], x[1], x[2]) * this->Units->Length);
  }
}

Index ModelReader::IndexOf(Id node, const Tree& where) const
{
  const auto found = this->IndexOfNode.find(node);
  if (found == this->IndexOfNode.end())
  {
    throw InputError(Label(where) + " has the node " + std::to_string(node) +
      ", which is not among the nodes of the file.");
  }
  return found->second;
}

palpate::ElementOrder ModelReader::OrderOf(const Tree& elements)
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
  throw InputError(Label(elements) + " has elements of the type '" + printable(type) +
    "'; a body has tetrahedra alone (tet4 or tet10). Mesh it with tetrahedra.");
}

void ModelReader::ReadElements()
{
  std::vector<Id> ids;
  std::vector<const Tree*> labels;
  std::vector<int> partOf;
  std::vector<Id> nodes;
  std::vector<const Tree*> parts;
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
        printable(Attribute(elements, "type")) +
        "', but others are before it: linear and quadratic tetrahedra cannot be mixed.");
    }
    order = OrderOf(elements);
    for (const Tree& element : elements.Children)
    {
      ids.push_back(IdOf(element));
      labels.push_back(&element);
      partOf.push_back(static_cast<int>(parts.size()));
      AppendNumbers(element.Text, element, nodes);
      if (nodes.size() != ids.size() * palpate::nodes_per_cell(*order))
      {
        throw InputError(Label(element) + " has not the " +
          std::to_string(palpate::nodes_per_cell(*order)) + " nodes of a " +
          printable(Attribute(elements, "type")) + '.');
      }
    }
    parts.push_back(&elements);
    const std::string* name = elements.Attribute("name");
    this->Model.Regions.push_back(name ? *name : "Part" + std::to_string(parts.size()));
  }
  if (ids.empty())
  {
    throw InputError("The file has no elements.");
  }

  palpate::TetMesh& mesh = this->Model.Scene.body.mesh;
  mesh.order = *order;
  const int nodesPerCell = palpate::nodes_per_cell(*order);
  // FEBio's order of the nodes is VTK's, midside nodes included: FETet10::shape_fnc.
  mesh.cells.reserve(nodes.size());
  for (const std::size_t place : Order(ids, "elements"))
  {
    for (int i = 0; i < nodesPerCell; ++i)
    {
      const Id node = nodes[place * nodesPerCell + i];
      mesh.cells.push_back(this->IndexOf(node, *labels[place]));
    }
    this->Elements.Ids.push_back(ids[place]);
    this->Model.RegionOfCell.push_back(partOf[place]);
  }
  this->ReadMaterials(parts);
}

void ModelReader::ReadMaterials(const std::vector<const Tree*>& parts)
{
  palpate::Scene& scene = this->Model.Scene;
  vtkPalpateFEBioMaterials materials(this->Root, this->Sets, *this->Units, this->Elements);
  std::vector<vtkPalpateFEBioMaterials::Part> all;
  for (const Tree* part : parts)
  {
    all.push_back(materials.Of(*part));
  }
  std::vector<Index> materialOfPart(parts.size(), NoMaterial);
  for (std::size_t cell = 0; cell < this->Elements.Ids.size(); ++cell)
  {
    const int number = this->Model.RegionOfCell[cell];
    if (materialOfPart[number] == NoMaterial || !all[number].Maps.empty())
    {
      materialOfPart[number] = static_cast<Index>(scene.organ.materials.size());
      const auto [material, rheology] = materials.Of(all[number], this->Elements.Ids[cell]);
      scene.organ.materials.push_back(material);
      this->Model.Rheologies.push_back(rheology);
    }
    scene.body.material_of_cell.push_back(materialOfPart[number]);
  }
  for (const std::string& warning : materials.Warnings())
  {
    this->Model.Warnings.push_back(warning);
  }
}

std::vector<Id> ModelReader::NodesOf(const std::string& reference, const Tree& where) const
{
  const std::string name = reference.substr(reference.find(':') + 1);
  std::vector<Id> nodes;
  if (StartsWith(reference, "@elem_set:"))
  {
    const palpate::TetMesh& mesh = this->Model.Scene.body.mesh;
    const int nodesPerCell = palpate::nodes_per_cell(mesh.order);
    const std::vector<Id>& all = this->Elements.Ids;
    for (const Id element : ElementsOf(this->Sets, name, where, this->Elements))
    {
      const auto cell = std::lower_bound(all.begin(), all.end(), element) - all.begin();
      for (int i = 0; i < nodesPerCell; ++i)
      {
        nodes.push_back(this->Nodes.Ids[mesh.cells[cell * nodesPerCell + i]]);
      }
    }
    return nodes;
  }
  if (const Tree* set = this->Sets.First(reference, { "NodeSet", "Nodes" }))
  {
    return IdsOf(*set, this->Nodes);
  }
  const Tree* set = StartsWith(reference, "@surface:") ? this->Sets.First(name, { "Surface" })
    : StartsWith(reference, "@edge:")                  ? this->Sets.First(name, { "Edge" })
                                                       : nullptr;
  if (!set)
  {
    throw InputError(Label(where) + " is about the nodes '" + printable(reference) +
      "', but there is no set of that name.");
  }
  for (const Tree& face : set->Children)
  {
    AppendNumbers(face.Text, face, nodes);
  }
  return nodes;
}
}

vtkPalpateFEBioModel vtkPalpateReadFEBio(const std::string& fileName, int units)
{
  const vtkPalpateXMLTree root = vtkPalpateReadXML(fileName);
  try
  {
    return vtkPalpateFEBio::ModelReader(root, units).Read();
  }
  catch (const palpate::InputError& error)
  {
    throw palpate::InputError(
      "The file " + palpate::quoted(fileName) + " cannot be read. " + error.what());
  }
}
