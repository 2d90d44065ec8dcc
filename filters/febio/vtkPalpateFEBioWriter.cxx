// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioWriter.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/new_file.h"
#include "base/printable.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFEBioOutput.h"
#include "vtkPalpateFEBioParts.h"
#include "vtkPalpateFEBioUnsaid.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using namespace vtkPalpateFEBio;
using palpate::BackendError;
using palpate::Index;
using palpate::InputError;
using palpate::Material;
using palpate::Rheology;
using palpate::Scene;

void WriteParameter(const Part& part, const CellParameter& parameter, Output& xml)
{
  if (part.Varies(parameter))
  {
    xml.Leaf(parameter.Name, { { "type", "map" } }, part.MapOf(parameter));
    return;
  }
  xml.Leaf(parameter.Name, {}, Text(parameter.OfCell(part.Cells.front())));
}

/// Writes the parameters of the law.
/// @param isOuter Writes those that belong to the outer material if the law is its <elastic>.
/// @param isInner Writes the others.
void WriteLaw(const Part& part, bool isOuter, bool isInner, Output& xml)
{
  for (const CellParameter& parameter : part.Parameters)
  {
    const bool isOfOuter = part.Law->IsUncoupled && std::string(parameter.Name) == "k";
    // FEBio admits no exponent of 0, also for a term of Ogden's law that is not used.
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
  const bool isLinear = scene.body.mesh.order == palpate::ElementOrder::linear;
  const int nodesPerCell = palpate::nodes_per_cell(scene.body.mesh.order);
  xml.Open("Elements", { { "type", isLinear ? "tet4" : "tet10" }, { "name", part.Name } });
  for (const Index cell : part.Cells)
  {
    // VTK's order of the nodes is FEBio's, midside nodes included: FETet10::shape_fnc.
    std::vector<Index> nodes(scene.body.mesh.cell(cell), scene.body.mesh.cell(cell) + nodesPerCell);
    for (Index& node : nodes)
    {
      ++node;
    }
    xml.Leaf("elem", { { "id", Text(cell + 1) } }, List(nodes));
  }
  xml.Close();
}

/// Writes a set of nodes, unless it is empty, which FEBio does not admit.
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
  std::vector<Support> supports = { { vtkPalpateArray::Fixed, all, scene.body.fixed } };
  for (int axes = 1; axes < all; ++axes)
  {
    Support support{ "Held_", axes, std::vector<char>(scene.body.fixed.size(), 0) };
    for (int axis = 0; axis < 3; ++axis)
    {
      support.Name += (axes & (1 << axis)) == 0 ? "" : std::string(1, "xyz"[axis]);
    }
    for (std::size_t point = 0; point < scene.body.held_directions.size(); ++point)
    {
      support.Points[point] =
        scene.body.fixed[point] == 0 && AxesOf(scene.body.held_directions[point]) == axes ? 1 : 0;
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
  /// The nodes of the faces.
  std::vector<Index> Faces;
};

std::vector<SurfaceLoad> LoadsOf(const Scene& scene)
{
  std::vector<SurfaceLoad> loads;
  std::map<std::pair<const char*, std::string>, std::size_t> known;
  const int size = palpate::nodes_per_face(scene.body.mesh.order);
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
    palpate::faces_under_pressure(scene.body.mesh, scene.body.applied_pressure);
  for (std::size_t i = 0; i < pressed.size(); i += size)
  {
    add(vtkPalpateArray::AppliedPressure, "pressure", Text(scene.body.applied_pressure[pressed[i]]),
      &pressed[i]);
  }
  const std::vector<Index> pulled =
    palpate::faces_with(scene.body.mesh, scene.body.applied_traction);
  for (std::size_t i = 0; i < pulled.size(); i += size)
  {
    const palpate::Vec3& traction = scene.body.applied_traction[pulled[i]];
    if (HasOneTraction(scene, &pulled[i]))
    {
      add(vtkPalpateArray::AppliedTraction, "traction", List(traction), &pulled[i]);
    }
  }
  return loads;
}

void WriteSurface(const Scene& scene, const SurfaceLoad& load, Output& xml)
{
  const bool isLinear = scene.body.mesh.order == palpate::ElementOrder::linear;
  const int size = palpate::nodes_per_face(scene.body.mesh.order);
  xml.Open("Surface", { { "name", load.Name } });
  for (std::size_t i = 0; i < load.Faces.size(); i += size)
  {
    // The faces look outward, with corners before midside nodes, in FEBio's order.
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
  for (Index point = 0; point < scene.body.mesh.num_points(); ++point)
  {
    const palpate::Vec3& x = scene.body.mesh.points[point];
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
  WriteNodeSet(vtkPalpateArray::Touchable, scene.body.touchable, xml);
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
    // By default FEBio takes the formulation with a pressure for every uncoupled material.
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

}

vtkStandardNewMacro(vtkPalpateFEBioWriter);

vtkPalpateFEBioWriter::vtkPalpateFEBioWriter() = default;

vtkPalpateFEBioWriter::~vtkPalpateFEBioWriter() = default;

int vtkPalpateFEBioWriter::Write()
{
  // The file is written again also if nothing has changed, since it may be gone.
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
