// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioModel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/printable.h"
#include "vtkMath.h"
#include "vtkPalpateFEBioMaterials.h"
#include "vtkPalpateFEBioText.h"
#include "vtkPalpateFEBioUnits.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateXMLTree.h"

namespace
{
using namespace vtkPalpateFEBio;
using palpate::Index;
using palpate::InputError;
using palpate::printable;

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
    this->Sets = ChildIndex(this->Mesh);
  }

  vtkPalpateFEBioModel Read()
  {
    this->ReadNodes();
    this->ReadElements();
    palpate::check_and_orient(this->Model.Scene.mesh);
    this->ReadLoads();
    this->ReadBoundary();
    return std::move(this->Model);
  }

private:
  void CheckVersion()
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

  void CheckConstraints(const Tree& section) const
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

  void CheckStep(const Tree& step)
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
          throw InputError(
            Label(node) + " has '" + printable(node.Text) + "' where three coordinates are due.");
        }
      }
    }
    this->IndexOfNode.reserve(ids.size());
    auto& points = this->Model.Scene.mesh.points;
    points.reserve(ids.size());
    for (const std::size_t place : Order(ids, "nodes"))
    {
      this->IndexOfNode[ids[place]] = static_cast<Index>(points.size());
      this->Nodes.Ids.push_back(ids[place]);
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
    throw InputError(Label(elements) + " has elements of the type '" + printable(type) +
      "'; a body has tetrahedra alone (tet4 or tet10). Mesh it with tetrahedra.");
  }

  void ReadElements()
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

    palpate::TetMesh& mesh = this->Model.Scene.mesh;
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

  /// @param parts Those of Model.Regions.
  void ReadMaterials(const std::vector<const Tree*>& parts)
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
        materialOfPart[number] = static_cast<Index>(scene.materials.size());
        const auto [material, rheology] = materials.Of(all[number], this->Elements.Ids[cell]);
        scene.materials.push_back(material);
        this->Model.Rheologies.push_back(rheology);
      }
      scene.material_of_cell.push_back(materialOfPart[number]);
    }
    for (const std::string& warning : materials.Warnings())
    {
      this->Model.Warnings.push_back(warning);
    }
  }

  /// The nodes of a set, of a surface (@surface:), an edge (@edge:) or elements (@elem_set:).
  std::vector<Id> NodesOf(const std::string& reference, const Tree& where) const
  {
    const std::string name = reference.substr(reference.find(':') + 1);
    std::vector<Id> nodes;
    if (StartsWith(reference, "@elem_set:"))
    {
      const palpate::TetMesh& mesh = this->Model.Scene.mesh;
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
    // What all conditions on a set hold, and the first of them: each set is gone through once.
    std::map<std::string, std::pair<int, const Tree*>> heldOf;
    for (const Tree& condition : ChildrenOf(boundary))
    {
      const std::string* type = condition.Attribute("type");
      const bool isFixed = condition.Name == "fix" ||
        (condition.Name == "bc" && type && (*type == "fix" || *type == "zero displacement"));
      // Degrees of freedom of shells and fluids, which a body does not have.
      const bool isOfOthers = type && StartsWith(*type, "zero ");
      if (isFixed)
      {
        auto& [held, first] = heldOf[Attribute(condition, "node_set")];
        held |= AxesOf(condition);
        first = first ? first : &condition;
      }
      else if (!this->LeaveOutPrescribed(condition) && !isOfOthers)
      {
        throw InputError("The condition " + Label(condition) +
          " is not read: points are held along the axes or free. Remove it from the model.");
      }
    }
    for (const auto& [set, held] : heldOf)
    {
      for (const Id node : this->NodesOf(set, *held.second))
      {
        axes[this->IndexOf(node, *held.second)] |= static_cast<char>(held.first);
      }
    }
    scene.fixed.assign(axes.size(), 0);
    const std::vector<char> used = palpate::points_in_use(scene.mesh);
    constexpr char allAxes = 7;
    for (std::size_t point = 0; point < axes.size(); ++point)
    {
      scene.fixed[point] = used[point] != 0 && axes[point] == allAxes ? 1 : 0;
      for (int axis = 0; axis < 3 && used[point] != 0; ++axis)
      {
        if ((axes[point] & (1 << axis)) != 0)
        {
          this->Hold(static_cast<Index>(point), palpate::Vec3::Unit(axis));
        }
      }
    }
    for (const Tree& constraint : ChildrenOf(this->Root.Child("Constraints")))
    {
      this->ReadSymmetryPlane(constraint);
    }
    const auto isFree = [](const palpate::HeldDirections& of) { return of.isZero(0); };
    if (std::all_of(scene.held_directions.begin(), scene.held_directions.end(), isFree))
    {
      scene.held_directions.clear();
    }
    if (std::find(scene.fixed.begin(), scene.fixed.end(), 1) == scene.fixed.end() &&
      scene.held_directions.empty())
    {
      this->Model.Warnings.emplace_back(
        "The model holds no point of the body. Apply Set Boundary to it.");
    }
    this->ReadTouchable();
  }

  /// Holds a point along one more direction, of the length 1; along three it is fixed.
  void Hold(Index point, const palpate::Vec3& direction)
  {
    palpate::Scene& scene = this->Model.Scene;
    const palpate::HeldDirections none = palpate::HeldDirections::Zero();
    palpate::HeldDirections held =
      scene.held_directions.empty() ? none : scene.held_directions[point];
    const palpate::Vec3 across = direction - held * (held.transpose() * direction);
    // The sine of the angle to those that it has.
    constexpr double same = 1e-6;
    if (scene.fixed[point] != 0 || across.norm() < same)
    {
      return;
    }
    const int column = held.col(0).isZero(0) ? 0 : held.col(1).isZero(0) ? 1 : 2;
    if (column == 2)
    {
      scene.fixed[point] = 1;
      held = none;
    }
    else
    {
      held.col(column) = across.normalized();
    }
    scene.held_directions.resize(scene.mesh.points.size(), none);
    scene.held_directions[point] = held;
  }

  using Face = std::vector<Index>;

  std::vector<Face> FacesOf(const std::string& name, const Tree& where) const
  {
    const Tree* set = this->Sets.First(name, { "Surface" });
    if (!set)
    {
      throw InputError(
        Label(where) + " is about the surface '" + printable(name) + "', which is not there.");
    }
    std::vector<Face> faces;
    for (const Tree& child : set->Children)
    {
      std::vector<Id> nodes;
      AppendNumbers(child.Text, child, nodes);
      if (nodes.size() != 3 && nodes.size() != 6)
      {
        throw InputError(Label(child) + " of the surface '" + printable(name) + "' has " +
          std::to_string(nodes.size()) + " nodes; that of a tetrahedron has 3 or 6.");
      }
      Face& face = faces.emplace_back();
      for (const Id node : nodes)
      {
        face.push_back(this->IndexOf(node, child));
      }
    }
    return faces;
  }

  /// Twice the area of its triangle is its length.
  palpate::Vec3 NormalOf(const Face& face) const
  {
    const auto& points = this->Model.Scene.mesh.points;
    const palpate::Vec3 one = points[face[1]] - points[face[0]];
    const palpate::Vec3 other = points[face[2]] - points[face[0]];
    palpate::Vec3 normal;
    vtkMath::Cross(one.data(), other.data(), normal.data());
    return normal;
  }

  void ReadSymmetryPlane(const Tree& constraint)
  {
    const std::vector<Face> faces = this->FacesOf(Attribute(constraint, "surface"), constraint);
    palpate::Vec3 normal = palpate::Vec3::Zero();
    double area = 0;
    for (const Face& face : faces)
    {
      normal += this->NormalOf(face);
      area += this->NormalOf(face).norm();
    }
    // Of a plane the two are the same.
    constexpr double plane = 1e-6;
    if (!(normal.norm() > (1 - plane) * area))
    {
      throw InputError(Label(constraint) + " is about the surface '" +
        printable(Attribute(constraint, "surface")) + "', which is no plane.");
    }
    for (const Face& face : faces)
    {
      for (const Index point : face)
      {
        this->Hold(point, normal.normalized());
      }
    }
  }

  void ReadLoads()
  {
    for (const Tree& load : ChildrenOf(this->Root.Child("Loads")))
    {
      if (!this->ReadLoad(load))
      {
        this->LeaveOut(load);
      }
    }
  }

  using Corners = std::array<Index, 3>;

  /// In the order of their numbers.
  static Corners CornersOf(const Face& face)
  {
    Corners corners = { face[0], face[1], face[2] };
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  /// The surface of the body.
  struct Boundary
  {
    std::vector<Face> Faces;
    /// The place of each in Faces.
    std::map<Corners, std::size_t> Of;
    /// The places of those of which a point is a corner.
    std::vector<std::vector<std::size_t>> At;
  };

  /// Made when a load is first read.
  const Boundary& Surface()
  {
    if (!this->Outside)
    {
      Boundary& outside = this->Outside.emplace();
      const palpate::TetMesh& mesh = this->Model.Scene.mesh;
      const std::vector<Index> nodes = palpate::boundary_faces(mesh);
      const int size = palpate::nodes_per_face(mesh.order);
      outside.At.resize(mesh.points.size());
      for (auto face = nodes.begin(); face != nodes.end(); face += size)
      {
        const std::size_t place = outside.Faces.size();
        outside.Faces.emplace_back(face, face + size);
        outside.Of[CornersOf(outside.Faces.back())] = place;
        for (int corner = 0; corner < 3; ++corner)
        {
          outside.At[face[corner]].push_back(place);
        }
      }
    }
    return *this->Outside;
  }

  /// 1 where all faces look out of the body, -1 where all look into it, else 0.
  int SideOf(const std::vector<Face>& faces)
  {
    const Boundary& outside = this->Surface();
    int out = 0;
    int in = 0;
    for (const Face& face : faces)
    {
      const auto found = outside.Of.find(CornersOf(face));
      if (found == outside.Of.end())
      {
        return 0;
      }
      const palpate::Vec3 outward = this->NormalOf(outside.Faces[found->second]);
      ++(this->NormalOf(face).dot(outward) > 0 ? out : in);
    }
    return in == 0 ? 1 : out == 0 ? -1 : 0;
  }

  /// Gives the points of faces of the surface a value.
  /// @param carries Whether an array loads a face with these corners.
  /// @returns False, and nothing is changed, where the array would not load these and those before.
  template <class Value, class Carries>
  bool Load(const std::vector<Face>& faces, const Value& value, const Value& none,
    std::vector<Value>& array, Carries&& carries)
  {
    const Boundary& outside = this->Surface();
    const bool isFirst = array.empty();
    array.resize(outside.At.size(), none);
    std::set<std::size_t> wanted;
    bool isNew = true;
    for (const Face& face : faces)
    {
      isNew = wanted.insert(outside.Of.at(CornersOf(face))).second && isNew &&
        !carries(array, face.data());
    }
    std::vector<Index> changed;
    for (const Face& face : faces)
    {
      for (const Index point : face)
      {
        isNew = isNew && (array[point] == none || array[point] == value);
        if (isNew && array[point] == none)
        {
          array[point] = value;
          changed.push_back(point);
        }
      }
    }
    // Where a corner has changed no face was loaded before. What is said twice changes nothing.
    const auto isAsWanted = [&](std::size_t face)
    { return carries(array, outside.Faces[face].data()) == (wanted.count(face) > 0); };
    const bool isRight = isNew && std::all_of(wanted.begin(), wanted.end(), isAsWanted) &&
      std::all_of(changed.begin(), changed.end(),
        [&](Index point)
        { return std::all_of(outside.At[point].begin(), outside.At[point].end(), isAsWanted); });
    if (!isRight)
    {
      for (const Index point : changed)
      {
        array[point] = none;
      }
      if (isFirst)
      {
        array.clear();
      }
    }
    return isRight;
  }

  /// A constant pressure or traction on faces of the surface, that may be said point by point.
  bool ReadLoad(const Tree& load)
  {
    const std::string* type = load.Attribute("type");
    const Tree* value = type ? load.Child(type->c_str()) : nullptr;
    const bool isPressure = type && *type == "pressure";
    if (load.Name != "surface_load" || !value || !(isPressure || *type == "traction"))
    {
      return false;
    }
    double scale = this->Units->Pressure;
    for (const Tree& child : load.Children)
    {
      const std::string* kind = child.Attribute("type");
      const bool varies = child.Attribute("lc") || (kind && *kind != "const");
      const bool isSwitch = child.Name == "linear" || child.Name == "shell_bottom";
      if (varies || (isSwitch && child.Text != "0"))
      {
        return false;
      }
      scale *= child.Name == "scale" ? NumberOf(child.Text, child) : 1;
    }
    std::vector<double> numbers;
    AppendNumbers(value->Text, *value, numbers);
    if (numbers.size() != (isPressure ? 1 : 3))
    {
      throw InputError(Label(load) + " has '" + printable(value->Text) + "' where " +
        (isPressure ? "one number is due." : "three numbers are due."));
    }
    for (double& number : numbers)
    {
      number *= scale;
      if (!std::isfinite(number))
      {
        throw InputError(Label(load) + " is not finite.");
      }
    }
    const std::vector<Face> faces = this->FacesOf(Attribute(load, "surface"), load);
    palpate::Scene& scene = this->Model.Scene;
    const int side = this->SideOf(faces);
    if (faces.empty() || side == 0)
    {
      return false;
    }
    if (isPressure)
    {
      return this->Load(
        faces, side * numbers[0], 0.0, scene.applied_pressure, palpate::is_under_pressure);
    }
    return this->Load(faces, palpate::Vec3(numbers[0], numbers[1], numbers[2]),
      palpate::Vec3(palpate::Vec3::Zero()), scene.applied_traction, palpate::has_traction);
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
        for (const Id node : IdsOf(set, this->Nodes))
        {
          scene.touchable[this->IndexOf(node, set)] = 1;
        }
        return;
      }
    }
    scene.touchable = vtkPalpateTouchableSurface(scene.mesh, vtkPalpateHeldPoints(scene));
  }

  static constexpr Index NoMaterial = -1;
  static constexpr const char* SymmetryPlane = "symmetry plane";

  const Tree& Root;
  const Tree* Mesh = nullptr;
  const vtkPalpateFEBioUnits* Units = nullptr;
  /// In the order of the points, and back.
  KnownIds Nodes{ {}, "node" };
  std::unordered_map<Id, Index> IndexOfNode;
  KnownIds Elements{ {}, "element" };
  /// Of the mesh.
  ChildIndex Sets{ nullptr };
  std::optional<Boundary> Outside;
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
    throw InputError("The file " + palpate::quoted(fileName) + " cannot be read. " + error.what());
  }
}
