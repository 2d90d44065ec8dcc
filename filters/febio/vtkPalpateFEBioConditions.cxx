// SPDX-License-Identifier: BSD-3-Clause
// Reads what holds and loads the model of a file, and where it may be touched.
#include "vtkPalpateFEBioModelReader.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/printable.h"
#include "vtkMath.h"
#include "vtkPalpateScene.h"

namespace vtkPalpateFEBio
{
using palpate::Index;
using palpate::InputError;
using palpate::printable;

int ModelReader::AxesOf(const Tree& condition)
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
      // Other names are degrees of freedom of shells.
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

void ModelReader::ReadBoundary()
{
  palpate::Scene& scene = this->Model.Scene;
  std::vector<char> axes(scene.body.mesh.points.size(), 0);
  const Tree* boundary = this->Root.Child("Boundary");
  // The axes that all conditions on a set hold, and the first of these conditions, so that each set
  // is visited once.
  std::map<std::string, std::pair<int, const Tree*>> heldOf;
  for (const Tree& condition : ChildrenOf(boundary))
  {
    const std::string* type = condition.Attribute("type");
    const bool isFixed = condition.Name == "fix" ||
      (condition.Name == "bc" && type && (*type == "fix" || *type == "zero displacement"));
    // These conditions are on degrees of freedom of shells and fluids, which a body does not have.
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
  scene.body.fixed.assign(axes.size(), 0);
  const std::vector<char> used = palpate::points_in_use(scene.body.mesh);
  constexpr char allAxes = 7;
  for (std::size_t point = 0; point < axes.size(); ++point)
  {
    scene.body.fixed[point] = used[point] != 0 && axes[point] == allAxes ? 1 : 0;
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
  if (std::all_of(scene.body.held_directions.begin(), scene.body.held_directions.end(), isFree))
  {
    scene.body.held_directions.clear();
  }
  if (std::find(scene.body.fixed.begin(), scene.body.fixed.end(), 1) == scene.body.fixed.end() &&
    scene.body.held_directions.empty())
  {
    this->Model.Warnings.emplace_back(
      "The model holds no point of the body. Apply Set Boundary to it.");
  }
  this->ReadTouchable();
}

void ModelReader::Hold(Index point, const palpate::Vec3& direction)
{
  palpate::Scene& scene = this->Model.Scene;
  const palpate::HeldDirections none = palpate::HeldDirections::Zero();
  palpate::HeldDirections held =
    scene.body.held_directions.empty() ? none : scene.body.held_directions[point];
  const palpate::Vec3 across = direction - held * (held.transpose() * direction);
  // The sine of the angle to the directions that the point has: below this they are the same.
  constexpr double same = 1e-6;
  if (scene.body.fixed[point] != 0 || across.norm() < same)
  {
    return;
  }
  const int column = held.col(0).isZero(0) ? 0 : held.col(1).isZero(0) ? 1 : 2;
  if (column == 2)
  {
    scene.body.fixed[point] = 1;
    held = none;
  }
  else
  {
    held.col(column) = across.normalized();
  }
  scene.body.held_directions.resize(scene.body.mesh.points.size(), none);
  scene.body.held_directions[point] = held;
}

std::vector<ModelReader::Face> ModelReader::FacesOf(
  const std::string& name, const Tree& where) const
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

palpate::Vec3 ModelReader::NormalOf(const Face& face) const
{
  const auto& points = this->Model.Scene.body.mesh.points;
  const palpate::Vec3 one = points[face[1]] - points[face[0]];
  const palpate::Vec3 other = points[face[2]] - points[face[0]];
  palpate::Vec3 normal;
  vtkMath::Cross(one.data(), other.data(), normal.data());
  return normal;
}

void ModelReader::ReadSymmetryPlane(const Tree& constraint)
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

void ModelReader::ReadLoads()
{
  for (const Tree& load : ChildrenOf(this->Root.Child("Loads")))
  {
    if (!this->ReadLoad(load))
    {
      this->LeaveOut(load);
    }
  }
}

ModelReader::Corners ModelReader::CornersOf(const Face& face)
{
  Corners corners = { face[0], face[1], face[2] };
  std::sort(corners.begin(), corners.end());
  return corners;
}

const ModelReader::Boundary& ModelReader::Surface()
{
  if (!this->Outside)
  {
    Boundary& outside = this->Outside.emplace();
    const palpate::TetMesh& mesh = this->Model.Scene.body.mesh;
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

int ModelReader::SideOf(const std::vector<Face>& faces)
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

template <class Value, class Carries>
bool ModelReader::Load(const std::vector<Face>& faces, const Value& value, const Value& none,
  std::vector<Value>& array, Carries&& carries)
{
  const Boundary& outside = this->Surface();
  const bool isFirst = array.empty();
  array.resize(outside.At.size(), none);
  std::set<std::size_t> wanted;
  bool isNew = true;
  for (const Face& face : faces)
  {
    isNew =
      wanted.insert(outside.Of.at(CornersOf(face))).second && isNew && !carries(array, face.data());
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
  // If a corner has changed, the face must not have been loaded before. The same load twice changes
  // nothing.
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

bool ModelReader::ReadLoad(const Tree& load)
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
      faces, side * numbers[0], 0.0, scene.body.applied_pressure, palpate::is_under_pressure);
  }
  return this->Load(faces, palpate::Vec3(numbers[0], numbers[1], numbers[2]),
    palpate::Vec3(palpate::Vec3::Zero()), scene.body.applied_traction, palpate::has_traction);
}

void ModelReader::ReadTouchable()
{
  palpate::Scene& scene = this->Model.Scene;
  for (const Tree& set : this->Mesh->Children)
  {
    const std::string* name = set.Attribute("name");
    if (set.Name == "NodeSet" && name && *name == vtkPalpateArray::Touchable)
    {
      scene.body.touchable.assign(scene.body.mesh.points.size(), 0);
      for (const Id node : IdsOf(set, this->Nodes))
      {
        scene.body.touchable[this->IndexOf(node, set)] = 1;
      }
      return;
    }
  }
  scene.body.touchable = vtkPalpateTouchableSurface(scene.body.mesh, vtkPalpateHeldPoints(scene));
}
}
