// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioWriter.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/join.h"
#include "base/new_file.h"
#include "base/printable.h"
#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLUtilities.h"

namespace
{
using palpate::BackendError;
using palpate::Index;
using palpate::InputError;
using palpate::Material;
using palpate::Rheology;
using palpate::Scene;

/// With as many digits as it takes to be read as the same number.
template <class Number>
void Append(Number number, std::string& text)
{
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

template <class Number>
std::string Text(Number number)
{
  std::string text;
  Append(number, text);
  return text;
}

/// With a comma between them.
template <class Numbers>
std::string List(const Numbers& numbers)
{
  std::string text;
  for (const auto number : numbers)
  {
    if (!text.empty())
    {
      text += ',';
    }
    Append(number, text);
  }
  return text;
}

/// Writes XML element by element, escaped by VTK: a tree of it all (vtkXMLDataElement) takes 2.5 KB
/// for each node of a mesh. FEBio takes white space about a word for a part of it, so what stands
/// in an element stands on its line.
class Output
{
public:
  using Attributes = std::initializer_list<std::pair<const char*, std::string>>;

  explicit Output(std::ostream& stream)
    : Stream(stream)
  {
    this->Stream << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  }

  void Open(const char* name, Attributes attributes = {})
  {
    this->Start(name, attributes);
    this->Stream << ">\n";
    this->Levels.push_back(name);
  }

  void Close()
  {
    const char* name = this->Levels.back();
    this->Levels.pop_back();
    this->Indent();
    this->Stream << "</" << name << ">\n";
  }

  void Leaf(const char* name, Attributes attributes, const std::string& text)
  {
    this->Start(name, attributes);
    this->Stream << '>';
    this->Escape(text);
    this->Stream << "</" << name << ">\n";
  }

  void Empty(const char* name, Attributes attributes)
  {
    this->Start(name, attributes);
    this->Stream << "/>\n";
  }

private:
  void Indent()
  {
    for (std::size_t i = 0; i < this->Levels.size(); ++i)
    {
      this->Stream << '\t';
    }
  }

  void Start(const char* name, Attributes attributes)
  {
    this->Indent();
    this->Stream << '<' << name;
    for (const auto& [key, value] : attributes)
    {
      this->Stream << ' ' << key << "=\"";
      this->Escape(value);
      this->Stream << '"';
    }
  }

  void Escape(const std::string& text)
  {
    vtkXMLUtilities::EncodeString(
      text.c_str(), VTK_ENCODING_UTF_8, this->Stream, VTK_ENCODING_UTF_8, 1);
  }

  std::ostream& Stream;
  std::vector<const char*> Levels;
};

/// The names of the regions, by their numbers: a field array.
constexpr const char* RegionNames = "Regions";

/// The region of each cell, and how it is called.
struct Regions
{
  /// Of the cells that has them; empty: the body has none.
  std::string Array;
  std::vector<double> OfCell;
  vtkStringArray* Names = nullptr;

  std::string NameOf(Index cell) const
  {
    const double region = this->OfCell[cell];
    if (this->Names && region >= 0 &&
      region < static_cast<double>(this->Names->GetNumberOfValues()))
    {
      const std::string name = this->Names->GetValue(static_cast<vtkIdType>(region));
      if (!name.empty())
      {
        return name;
      }
    }
    return this->Array.empty() ? "Body" : "Region" + Text(region);
  }
};

Regions RegionsOf(vtkUnstructuredGrid* body)
{
  Regions regions;
  regions.OfCell.assign(static_cast<std::size_t>(body->GetNumberOfCells()), 0);
  // Of a label map, and of the surfaces of a body.
  for (const char* name : { "RegionId", "Region" })
  {
    vtkDataArray* array = body->GetCellData()->GetArray(name);
    if (array && array->GetNumberOfComponents() == 1)
    {
      regions.Array = name;
      for (std::size_t cell = 0; cell < regions.OfCell.size(); ++cell)
      {
        regions.OfCell[cell] = array->GetComponent(static_cast<vtkIdType>(cell), 0);
      }
      regions.Names =
        vtkStringArray::SafeDownCast(body->GetFieldData()->GetAbstractArray(RegionNames));
      break;
    }
  }
  return regions;
}

/// What FEBio's file says of the materials of a body.
struct Body
{
  palpate::Scene Scene;
  /// Of each of the scene's materials.
  std::vector<Rheology> Rheologies;

  Index MaterialIndex(Index cell) const { return this->Scene.material_of_cell[cell]; }
  const Material& MaterialOf(Index cell) const
  {
    return this->Scene.materials[this->MaterialIndex(cell)];
  }
  const Rheology& RheologyOf(Index cell) const
  {
    return this->Rheologies[this->MaterialIndex(cell)];
  }
  bool HasDensity() const { return palpate::has_density(this->Rheologies); }
};

/// A parameter of a material in FEBio's terms.
struct CellParameter
{
  const char* Name;
  std::function<double(Index)> OfCell;
  bool MayVary;
};

CellParameter DensityOf(const Body& body)
{
  return { "density", [&body](Index cell) { return body.RheologyOf(cell).density; }, true };
}

std::vector<CellParameter> ParametersOf(const vtkPalpateFEBioLaw& law, const Body& body)
{
  std::vector<CellParameter> all;
  for (const vtkPalpateFEBioLaw::Parameter& one : law.Parameters)
  {
    all.push_back({ one.Name,
      [&body, &one](Index cell)
      { return body.MaterialOf(cell).parameters[one.Index] * one.Factor; },
      one.MayVary });
  }
  return all;
}

/// Cells with the same material, but for parameters that vary from cell to cell.
struct Part
{
  std::string Name;
  const vtkPalpateFEBioLaw* Law;
  palpate::Formulation Formulation;
  std::vector<Index> Cells;
  /// Of the law.
  std::vector<CellParameter> Parameters;
  std::optional<CellParameter> Density;

  bool Varies(const CellParameter& parameter) const
  {
    const double first = parameter.OfCell(this->Cells.front());
    return std::any_of(this->Cells.begin(), this->Cells.end(),
      [&](Index cell) { return parameter.OfCell(cell) != first; });
  }
  std::string MapOf(const CellParameter& parameter) const
  {
    return this->Name + '_' + parameter.Name;
  }
  /// With a pressure of its own, which FEBio gives to uncoupled materials alone.
  bool IsThreeField() const
  {
    return this->Law->IsUncoupled && palpate::is_mixed(this->Formulation);
  }
};

/// Cells of one region, law, viscosity and formulation, whose parameters are the same: all of them,
/// or with `mayVary` those that FEBio takes as one number alone.
std::vector<Part> PartsOf(const Body& body, const Regions& regions,
  const std::vector<const vtkPalpateFEBioLaw*>& laws, bool mayVary)
{
  using Key = std::tuple<double, const vtkPalpateFEBioLaw*, palpate::Formulation,
    std::array<double, palpate::max_parameters>, palpate::RheologyValues>;
  std::map<Key, std::size_t> known;
  std::vector<Part> parts;
  for (Index cell = 0; cell < body.Scene.mesh.num_cells(); ++cell)
  {
    const Material& material = body.MaterialOf(cell);
    const vtkPalpateFEBioLaw* law = laws[body.MaterialIndex(cell)];
    auto parameters = material.parameters;
    Rheology rheology = body.RheologyOf(cell);
    // It is left out.
    rheology.viscous_time = 0;
    if (mayVary)
    {
      rheology.density = 0;
      for (const vtkPalpateFEBioLaw::Parameter& parameter : law->Parameters)
      {
        parameters[parameter.Index] = parameter.MayVary ? 0 : parameters[parameter.Index];
      }
    }
    const auto [found, isNew] =
      known.try_emplace(Key{ regions.OfCell[cell], law, material.formulation, parameters,
                          palpate::values_of(rheology) },
        parts.size());
    if (isNew)
    {
      parts.push_back(
        { regions.NameOf(cell), law, material.formulation, {}, ParametersOf(*law, body),
          body.HasDensity() ? std::optional(DensityOf(body)) : std::nullopt });
    }
    parts[found->second].Cells.push_back(cell);
  }

  // Names that others have get a number.
  std::set<std::string> names;
  for (Part& part : parts)
  {
    const std::string name = part.Name;
    for (int number = 2; !names.insert(part.Name).second; ++number)
    {
      part.Name = name + '_' + std::to_string(number);
    }
  }
  return parts;
}

std::vector<Part> PartsOf(const Body& body, const Regions& regions)
{
  std::vector<const vtkPalpateFEBioLaw*> laws;
  for (const Material& material : body.Scene.materials)
  {
    laws.push_back(&vtkPalpateFEBioLawOf(material));
  }
  constexpr std::size_t most = vtkPalpateFEBioWriter::MostParts;
  std::vector<Part> parts = PartsOf(body, regions, laws, false);
  if (parts.size() > most)
  {
    parts = PartsOf(body, regions, laws, true);
  }
  if (parts.size() > most)
  {
    throw InputError("The body has " + std::to_string(parts.size()) +
      " parts for FEBio, which differ in their region, their law or a parameter that FEBio takes "
      "as one number for a material (BulkModulus, OgdenExponent1 to 3, PronyModulus and "
      "PronyTime); at most " +
      std::to_string(most) + " are written. Let those parameters be the same in more cells.");
  }
  return parts;
}

void WriteParameter(const Part& part, const CellParameter& parameter, Output& xml)
{
  if (part.Varies(parameter))
  {
    xml.Leaf(parameter.Name, { { "type", "map" } }, part.MapOf(parameter));
    return;
  }
  xml.Leaf(parameter.Name, {}, Text(parameter.OfCell(part.Cells.front())));
}

/// The parameters of the law.
/// @param isOuter Those that belong to the material where the law is its <elastic>.
/// @param isInner The others.
void WriteLaw(const Part& part, bool isOuter, bool isInner, Output& xml)
{
  for (const CellParameter& parameter : part.Parameters)
  {
    const bool isOfOuter = part.Law->IsUncoupled && std::string(parameter.Name) == "k";
    // Of a term of Ogden's that is not there, FEBio admits no exponent of 0.
    const bool isThere = part.Law->Law != palpate::Law::ogden || part.Varies(parameter) ||
      parameter.OfCell(part.Cells.front()) != 0;
    if (isThere && (isOfOuter ? isOuter : isInner))
    {
      WriteParameter(part, parameter, xml);
    }
  }
  if (part.Law->IsUncoupled && isOuter)
  {
    xml.Leaf("pressure_model", {}, vtkPalpateFEBioPressureModel::Ours().Number);
  }
}

/// Whether it has a Prony series.
bool Relaxes(const Rheology& rheology)
{
  return std::any_of(rheology.prony_moduli.begin(), rheology.prony_moduli.end(),
    [](double modulus) { return modulus > 0; });
}

void WriteMaterial(const Body& body, const Part& part, std::size_t number, Output& xml)
{
  const Rheology& rheology = body.RheologyOf(part.Cells.front());
  const bool relaxes = Relaxes(rheology);
  const char* type = !relaxes ? part.Law->Type
    : part.IsThreeField()     ? vtkPalpateFEBioLaw::UncoupledViscoelastic
                              : vtkPalpateFEBioLaw::Viscoelastic;
  xml.Open("material", { { "id", Text(number) }, { "name", part.Name }, { "type", type } });
  if (part.Density)
  {
    WriteParameter(part, *part.Density, xml);
  }
  if (!relaxes)
  {
    WriteLaw(part, true, true, xml);
    xml.Close();
    return;
  }
  for (int j = 0; j < palpate::max_prony_terms; ++j)
  {
    if (rheology.prony_moduli[j] > 0)
    {
      const std::string place = std::to_string(j + 1);
      xml.Leaf(("g" + place).c_str(), {}, Text(rheology.prony_moduli[j]));
      xml.Leaf(("t" + place).c_str(), {}, Text(rheology.prony_times[j]));
    }
  }
  // FEBio takes k and the pressure_model from the outermost of uncoupled materials, of which
  // 'viscoelastic' is none.
  if (part.IsThreeField())
  {
    WriteLaw(part, true, false, xml);
  }
  xml.Open("elastic", { { "type", part.Law->Type } });
  WriteLaw(part, !part.IsThreeField(), true, xml);
  xml.Close();
  xml.Close();
}

void WriteElements(const Scene& scene, const Part& part, Output& xml)
{
  const bool isLinear = scene.mesh.order == palpate::ElementOrder::linear;
  const int nodesPerCell = palpate::nodes_per_cell(scene.mesh.order);
  xml.Open("Elements", { { "type", isLinear ? "tet4" : "tet10" }, { "name", part.Name } });
  for (const Index cell : part.Cells)
  {
    // VTK's order of the nodes is FEBio's, midside nodes included: FETet10::shape_fnc.
    std::vector<Index> nodes(scene.mesh.cell(cell), scene.mesh.cell(cell) + nodesPerCell);
    for (Index& node : nodes)
    {
      ++node;
    }
    xml.Leaf("elem", { { "id", Text(cell + 1) } }, List(nodes));
  }
  xml.Close();
}

/// FEBio has no empty sets.
void WriteNodeSet(const char* name, const std::vector<char>& chosen, Output& xml)
{
  std::vector<std::size_t> ids;
  for (std::size_t point = 0; point < chosen.size(); ++point)
  {
    if (chosen[point] != 0)
    {
      ids.push_back(point + 1);
    }
  }
  if (!ids.empty())
  {
    xml.Leaf("NodeSet", { { "name", name } }, List(ids));
  }
}

/// The axes along which FEBio holds a point, 1, 2 and 4 for x, y and z; none: it holds none so.
std::optional<int> AxesOf(const palpate::HeldDirections& held)
{
  // What is held is the space that the directions span: a projection.
  const palpate::Mat3 projection = held * held.transpose();
  int axes = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    axes |= projection(axis, axis) > 0.5 ? 1 << axis : 0;
  }
  palpate::Mat3 rounded = palpate::Mat3::Zero();
  for (int axis = 0; axis < 3; ++axis)
  {
    rounded(axis, axis) = (axes >> axis) & 1;
  }
  constexpr double rounding = 1e-12;
  return (projection - rounded).norm() < rounding ? std::optional(axes) : std::nullopt;
}

/// Points that are held along the same axes.
struct Support
{
  std::string Name;
  int Axes;
  std::vector<char> Points;
};

std::vector<Support> SupportsOf(const Scene& scene)
{
  constexpr int all = 7;
  std::vector<Support> supports = { { vtkPalpateArray::Fixed, all, scene.fixed } };
  for (int axes = 1; axes < all; ++axes)
  {
    Support support{ "Held_", axes, std::vector<char>(scene.fixed.size(), 0) };
    for (int axis = 0; axis < 3; ++axis)
    {
      support.Name += (axes & (1 << axis)) == 0 ? "" : std::string(1, "xyz"[axis]);
    }
    for (std::size_t point = 0; point < scene.held_directions.size(); ++point)
    {
      support.Points[point] =
        scene.fixed[point] == 0 && AxesOf(scene.held_directions[point]) == axes ? 1 : 0;
    }
    supports.push_back(std::move(support));
  }
  supports.erase(std::remove_if(supports.begin(), supports.end(),
                   [](const Support& support) {
                     return std::find(support.Points.begin(), support.Points.end(), 1) ==
                       support.Points.end();
                   }),
    supports.end());
  return supports;
}

/// Faces of the surface under the same load.
struct SurfaceLoad
{
  std::string Name;
  /// FEBio's type, which is the name of its parameter too.
  const char* Type;
  std::string Value;
  /// Their nodes.
  std::vector<Index> Faces;
};

/// Whether a face has one traction, as FEBio's have.
bool HasOneTraction(const Scene& scene, const Index* face)
{
  const std::vector<palpate::Vec3>& traction = scene.applied_traction;
  return traction[face[0]] == traction[face[1]] && traction[face[0]] == traction[face[2]];
}

std::vector<SurfaceLoad> LoadsOf(const Scene& scene)
{
  std::vector<SurfaceLoad> loads;
  std::map<std::pair<const char*, std::string>, std::size_t> known;
  const int size = palpate::nodes_per_face(scene.mesh.order);
  const auto add =
    [&](const char* array, const char* type, const std::string& value, const Index* face)
  {
    const auto [found, isNew] = known.try_emplace({ type, value }, loads.size());
    if (isNew)
    {
      loads.push_back({ array + ('_' + std::to_string(loads.size() + 1)), type, value, {} });
    }
    std::vector<Index>& faces = loads[found->second].Faces;
    faces.insert(faces.end(), face, face + size);
  };
  const std::vector<Index> pressed =
    palpate::faces_under_pressure(scene.mesh, scene.applied_pressure);
  for (std::size_t i = 0; i < pressed.size(); i += size)
  {
    add(vtkPalpateArray::AppliedPressure, "pressure", Text(scene.applied_pressure[pressed[i]]),
      &pressed[i]);
  }
  const std::vector<Index> pulled = palpate::faces_with(scene.mesh, scene.applied_traction);
  for (std::size_t i = 0; i < pulled.size(); i += size)
  {
    const palpate::Vec3& traction = scene.applied_traction[pulled[i]];
    if (HasOneTraction(scene, &pulled[i]))
    {
      add(vtkPalpateArray::AppliedTraction, "traction", List(traction), &pulled[i]);
    }
  }
  return loads;
}

void WriteSurface(const Scene& scene, const SurfaceLoad& load, Output& xml)
{
  const bool isLinear = scene.mesh.order == palpate::ElementOrder::linear;
  const int size = palpate::nodes_per_face(scene.mesh.order);
  xml.Open("Surface", { { "name", load.Name } });
  for (std::size_t i = 0; i < load.Faces.size(); i += size)
  {
    // Outward, corners before midside nodes, in FEBio's order.
    std::vector<Index> nodes(load.Faces.begin() + i, load.Faces.begin() + i + size);
    for (Index& node : nodes)
    {
      ++node;
    }
    xml.Leaf(isLinear ? "tri3" : "tri6", { { "id", Text(i / size + 1) } }, List(nodes));
  }
  xml.Close();
}

void WriteMesh(const Scene& scene, const std::vector<Part>& parts, Output& xml)
{
  xml.Open("Mesh");
  xml.Open("Nodes", { { "name", "Nodes" } });
  for (Index point = 0; point < scene.mesh.num_points(); ++point)
  {
    const palpate::Vec3& x = scene.mesh.points[point];
    xml.Leaf("node", { { "id", Text(point + 1) } }, List(std::array{ x[0], x[1], x[2] }));
  }
  xml.Close();
  for (const Part& part : parts)
  {
    WriteElements(scene, part, xml);
  }
  for (const Support& support : SupportsOf(scene))
  {
    WriteNodeSet(support.Name.c_str(), support.Points, xml);
  }
  for (const SurfaceLoad& load : LoadsOf(scene))
  {
    WriteSurface(scene, load, xml);
  }
  WriteNodeSet(vtkPalpateArray::Touchable, scene.touchable, xml);
  xml.Close();
}

void WriteMap(const Part& part, const CellParameter& parameter, Output& xml)
{
  xml.Open("ElementData",
    { { "name", part.MapOf(parameter) }, { "elem_set", part.Name }, { "data_type", "scalar" } });
  std::size_t place = 0;
  for (const Index cell : part.Cells)
  {
    xml.Leaf("elem", { { "lid", Text(++place) } }, Text(parameter.OfCell(cell)));
  }
  xml.Close();
}

void WriteMaps(const std::vector<Part>& parts, Output& xml)
{
  std::vector<std::pair<const Part*, const CellParameter*>> maps;
  for (const Part& part : parts)
  {
    for (const CellParameter& parameter : part.Parameters)
    {
      maps.emplace_back(&part, &parameter);
    }
    if (part.Density)
    {
      maps.emplace_back(&part, &*part.Density);
    }
  }
  maps.erase(std::remove_if(maps.begin(), maps.end(),
               [](const auto& map) { return !map.first->Varies(*map.second); }),
    maps.end());
  if (maps.empty())
  {
    return;
  }
  xml.Open("MeshData");
  for (const auto& [part, parameter] : maps)
  {
    WriteMap(*part, *parameter, xml);
  }
  xml.Close();
}

void WriteBoundary(const Scene& scene, Output& xml)
{
  xml.Open("Boundary");
  for (const Support& support : SupportsOf(scene))
  {
    xml.Open("bc",
      { { "name", support.Name }, { "type", "zero displacement" }, { "node_set", support.Name } });
    for (int axis = 0; axis < 3; ++axis)
    {
      constexpr const char* names[] = { "x_dof", "y_dof", "z_dof" };
      xml.Leaf(names[axis], {}, Text((support.Axes >> axis) & 1));
    }
    xml.Close();
  }
  xml.Close();
  const std::vector<SurfaceLoad> loads = LoadsOf(scene);
  if (loads.empty())
  {
    return;
  }
  xml.Open("Loads");
  for (const SurfaceLoad& load : loads)
  {
    xml.Open(
      "surface_load", { { "name", load.Name }, { "type", load.Type }, { "surface", load.Name } });
    xml.Leaf(load.Type, {}, load.Value);
    xml.Close();
  }
  xml.Close();
}

void WriteModel(const Body& body, const std::vector<Part>& parts, std::ostream& stream)
{
  const Scene& scene = body.Scene;
  Output xml(stream);
  xml.Open("febio_spec", { { "version", "4.0" } });
  xml.Open("Module", { { "type", "solid" } });
  xml.Leaf("units", {}, "SI");
  xml.Close();
  xml.Open("Material");
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    WriteMaterial(body, parts[i], i + 1, xml);
  }
  xml.Close();
  WriteMesh(scene, parts, xml);
  xml.Open("MeshDomains");
  for (const Part& part : parts)
  {
    // Of its own FEBio takes the one with a pressure for every uncoupled material.
    xml.Empty("SolidDomain",
      { { "name", part.Name }, { "mat", part.Name },
        { "type", part.IsThreeField() ? "three-field-solid" : "elastic-solid" } });
  }
  xml.Close();
  WriteMaps(parts, xml);
  WriteBoundary(scene, xml);
  xml.Close();
}

/// The file appears whole or not at all, so that one of that name is not lost.
void WriteFile(const Body& body, const std::vector<Part>& parts, const std::string& name)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path target = palpate::without_links(name);
  const fs::file_status there = fs::status(target, error);
  if (fs::is_fifo(there) || fs::is_socket(there))
  {
    throw InputError("The file " + palpate::quoted(name) +
      " is a pipe, at which ParaView would wait for a reader. Name a file.");
  }
  const bool isDevice = fs::exists(there) && !fs::is_regular_file(there);
  std::optional<palpate::NewFile> whole;
  if (!isDevice)
  {
    whole.emplace(target);
  }
  std::ofstream file(isDevice ? target : whole->path(), std::ios::binary);
  if (file)
  {
    WriteModel(body, parts, file);
    file.close();
  }
  if (!file)
  {
    throw BackendError("The file " + palpate::quoted(name) +
      " cannot be written: " + std::generic_category().message(errno) +
      ". Choose a folder that is there, may be written to and has room.");
  }
  if (whole)
  {
    whole->replace();
  }
}

/// The names of arrays that the file has in another form.
std::set<std::string> WrittenArrays()
{
  std::set<std::string> names = { vtkPalpateArray::Fixed, vtkPalpateArray::Touchable,
    vtkPalpateArray::BoundaryKind, vtkPalpateArray::HeldDirection, vtkPalpateArray::HeldDirection2,
    vtkPalpateArray::SupportStiffness, vtkPalpateArray::AppliedPressure,
    vtkPalpateArray::AppliedTraction, vtkPalpateArray::Law, vtkPalpateArray::Formulation,
    RegionNames };
  for (int law = 0; law < palpate::num_laws; ++law)
  {
    const auto& parameters = palpate::parameter_names(static_cast<palpate::Law>(law));
    names.insert(parameters.begin(), parameters.end());
  }
  names.insert(palpate::rheology_names().begin(), palpate::rheology_names().end());
  return names;
}

/// Names the arrays that are in no other form in the file.
std::string ArraysLeftOut(vtkUnstructuredGrid* grid, const Regions& regions)
{
  std::set<std::string> written = WrittenArrays();
  written.insert(regions.Array);
  std::vector<std::string> left;
  const std::pair<vtkFieldData*, const char*> all[] = { { grid->GetPointData(), "points" },
    { grid->GetCellData(), "cells" }, { grid->GetFieldData(), "field" } };
  for (const auto& [data, where] : all)
  {
    auto* attributes = vtkDataSetAttributes::SafeDownCast(data);
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = data->GetAbstractArray(i);
      const std::string name = array->GetName() ? array->GetName() : "";
      // What the pieces of a body are joined by.
      const bool isOfPieces = name == vtkDataSetAttributes::GhostArrayName() ||
        (attributes && array == attributes->GetGlobalIds());
      if (written.count(name) == 0 && !isOfPieces)
      {
        left.push_back("'" + palpate::printable(name) + "' (" + where + ')');
      }
    }
  }
  return left.empty()
    ? ""
    : "Arrays that FEBio's file has no place for are left out: " + palpate::join(left) + ". ";
}

/// Whether the reader, which numbers the parts, finds another number for a cell.
bool AreRenumbered(const Regions& regions, const std::vector<Part>& parts)
{
  const auto isOther = [&](std::size_t number)
  {
    return std::any_of(parts[number].Cells.begin(), parts[number].Cells.end(),
      [&](Index cell) { return regions.OfCell[cell] != static_cast<double>(number); });
  };
  std::vector<std::size_t> numbers(parts.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return regions.Array != "RegionId" || std::any_of(numbers.begin(), numbers.end(), isOther);
}

/// A sentence about each thing that FEBio's file does not say, or FEBio computes otherwise; empty
/// where it says all.
std::string Unsaid(vtkUnstructuredGrid* grid, const Body& body, const Regions& regions,
  const std::vector<Part>& parts)
{
  std::string text;
  const auto isAny = [&](auto&& what)
  {
    return std::any_of(parts.begin(), parts.end(),
      [&](const Part& part) { return what(part, body.MaterialOf(part.Cells.front())); });
  };
  const auto locks = [](const Part& part, const Material&)
  { return palpate::is_mixed(part.Formulation) && !part.IsThreeField(); };
  if (isAny(locks))
  {
    text += "Part of the body is nearly incompressible and of a law that FEBio solves by "
            "displacements alone, which makes it too stiff: the law is the same, FEBio's answer is "
            "not. Mooney-Rivlin and Ogden have elements with a pressure in FEBio too. ";
  }
  if (isAny([&](const Part& part, const Material& material)
        { return locks(part, material) && Relaxes(body.RheologyOf(part.Cells.front())); }))
  {
    text += "Its Prony series (PronyModulus1 to 4) relaxes in shape alone here, and in volume too "
            "in FEBio. ";
  }
  if (isAny(
        [](const Part& part, const Material& material)
        {
          const palpate::Material usual = palpate::make_material(material.law, material.parameters);
          return !part.Law->IsUncoupled &&
            palpate::is_mixed(usual.formulation) != palpate::is_mixed(material.formulation);
        }))
  {
    text += "The array Formulation is left out: FEBio has none for such laws, and who reads the "
            "file takes the one that suits. ";
  }
  if (std::any_of(body.Rheologies.begin(), body.Rheologies.end(),
        [](const Rheology& rheology) { return rheology.viscous_time > 0; }))
  {
    text += "The viscosity of Kelvin and Voigt, ViscousTime, is left out: FEBio has none of the "
            "same stress. ";
  }
  if (isAny([](const Part& part, const Material&)
        { return part.Formulation == palpate::Formulation::mixed_fine; }))
  {
    text += "Part of the body has the Quadrature Fine, which the file does not say: who reads it "
            "finds the standard one. ";
  }
  const std::vector<palpate::HeldDirections>& held = body.Scene.held_directions;
  if (std::any_of(held.begin(), held.end(),
        [](const palpate::HeldDirections& of) { return !AxesOf(of).has_value(); }))
  {
    text += "Points with a HeldDirection that is not along x, y or z are free in the file: FEBio "
            "holds points along its axes alone. Turn the body so that its planes of symmetry are "
            "across them. ";
  }
  if (!body.Scene.support_stiffness.empty())
  {
    text += "SupportStiffness is left out: FEBio has no springs by area, and the file holds the "
            "body without them. ";
  }
  const std::vector<Index> pulled =
    palpate::faces_with(body.Scene.mesh, body.Scene.applied_traction);
  for (std::size_t i = 0; i < pulled.size(); i += palpate::nodes_per_face(body.Scene.mesh.order))
  {
    if (!HasOneTraction(body.Scene, &pulled[i]))
    {
      text += "AppliedTraction is left out on faces whose corners have different ones. ";
      break;
    }
  }
  if (std::find(body.Scene.touchable.begin(), body.Scene.touchable.end(), 1) ==
    body.Scene.touchable.end())
  {
    text += "No point may be touched, and FEBio has no empty sets: who reads the file finds every "
            "free corner of the surface touchable. ";
  }
  if (!regions.Array.empty() && AreRenumbered(regions, parts))
  {
    text += "The numbers of " + regions.Array +
      " are in the names of the parts alone: who reads the file finds RegionId counted from 0, "
      "part by part. ";
  }
  return text + ArraysLeftOut(grid, regions);
}
}

vtkStandardNewMacro(vtkPalpateFEBioWriter);

vtkPalpateFEBioWriter::vtkPalpateFEBioWriter() = default;

vtkPalpateFEBioWriter::~vtkPalpateFEBioWriter() = default;

int vtkPalpateFEBioWriter::Write()
{
  // Written again also where nothing has changed: the file may be gone.
  this->Modified();
  this->Writes = true;
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->UpdatePiece(controller ? controller->GetLocalProcessId() : 0,
    controller ? controller->GetNumberOfProcesses() : 1, 0);
  this->Writes = false;
  return this->ErrorCode == 0;
}

int vtkPalpateFEBioWriter::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateFEBioWriter::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (!this->Writes)
  {
    return 1;
  }
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
      if (this->FileName.empty())
      {
        throw InputError("No file is named. Set FileName to a .feb file.");
      }
      Body whole;
      whole.Scene = vtkPalpateSceneFromGrid(body, whole.Rheologies);
      const Regions regions = RegionsOf(body);
      const std::vector<Part> parts = PartsOf(whole, regions);
      WriteFile(whole, parts, this->FileName);
      const std::string unsaid = Unsaid(body, whole, regions, parts);
      if (!unsaid.empty())
      {
        vtkPalpateWarn(
          this, unsaid + "The file " + palpate::quoted(this->FileName) + " is written.");
      }
    });
  return 1;
}

void vtkPalpateFEBioWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n';
}
