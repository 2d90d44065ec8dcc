// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateFEBioWriter.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <map>
#include <numeric>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFEBioLaw.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLUtilities.h"

namespace
{
using palpate::BackendError;
using palpate::Index;
using palpate::InputError;
using palpate::Material;
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

/// The region of each cell, and what its name begins with.
struct Regions
{
  std::string Name = "Body";
  std::vector<double> OfCell;
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
      regions.Name = "Region";
      for (std::size_t cell = 0; cell < regions.OfCell.size(); ++cell)
      {
        regions.OfCell[cell] = array->GetComponent(static_cast<vtkIdType>(cell), 0);
      }
      break;
    }
  }
  return regions;
}

/// Cells with the same material, but for parameters that vary from cell to cell.
struct Part
{
  std::string Name;
  const vtkPalpateFEBioLaw* Law;
  palpate::Formulation Formulation;
  std::vector<Index> Cells;
  /// Those that are not the same in all cells.
  std::vector<const vtkPalpateFEBioLaw::Parameter*> Varying;
};

const Material& MaterialOf(const Scene& scene, Index cell)
{
  return scene.materials[scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell]];
}

double Theirs(const Material& material, const vtkPalpateFEBioLaw::Parameter& parameter)
{
  return material.parameters[parameter.Index] * parameter.Factor;
}

/// Cells of one region, law and formulation, whose parameters are the same: all of them, or with
/// `mayVary` those that FEBio takes as one number alone.
std::vector<Part> PartsOf(const Scene& scene, const Regions& regions,
  const std::vector<const vtkPalpateFEBioLaw*>& laws, bool mayVary)
{
  using Key = std::tuple<double, const vtkPalpateFEBioLaw*, palpate::Formulation,
    std::array<double, palpate::max_parameters>>;
  std::map<Key, std::size_t> known;
  std::vector<Part> parts;
  for (Index cell = 0; cell < scene.mesh.num_cells(); ++cell)
  {
    const Material& material = MaterialOf(scene, cell);
    const vtkPalpateFEBioLaw* law =
      laws[scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell]];
    auto parameters = material.parameters;
    for (const vtkPalpateFEBioLaw::Parameter& parameter : law->Parameters)
    {
      if (mayVary && parameter.MayVary)
      {
        parameters[parameter.Index] = 0;
      }
    }
    const auto [found, isNew] = known.try_emplace(
      Key{ regions.OfCell[cell], law, material.formulation, parameters }, parts.size());
    if (isNew)
    {
      parts.push_back({ {}, law, material.formulation, {}, {} });
      const bool isBody = regions.Name == "Body";
      parts.back().Name = regions.Name + (isBody ? "" : Text(regions.OfCell[cell]));
    }
    parts[found->second].Cells.push_back(cell);
  }

  std::map<std::string, int> count;
  for (Part& part : parts)
  {
    const int number = ++count[part.Name];
    part.Name += number == 1 ? "" : '_' + std::to_string(number);
    for (const vtkPalpateFEBioLaw::Parameter& parameter : part.Law->Parameters)
    {
      const auto value = [&](Index cell)
      { return MaterialOf(scene, cell).parameters[parameter.Index]; };
      if (std::any_of(part.Cells.begin(), part.Cells.end(),
            [&](Index cell) { return value(cell) != value(part.Cells.front()); }))
      {
        part.Varying.push_back(&parameter);
      }
    }
  }
  return parts;
}

std::vector<Part> PartsOf(const Scene& scene, const Regions& regions)
{
  std::vector<const vtkPalpateFEBioLaw*> laws;
  for (const Material& material : scene.materials)
  {
    laws.push_back(&vtkPalpateFEBioLawOf(material));
  }
  constexpr std::size_t most = vtkPalpateFEBioWriter::MostParts;
  std::vector<Part> parts = PartsOf(scene, regions, laws, false);
  if (parts.size() > most)
  {
    parts = PartsOf(scene, regions, laws, true);
  }
  if (parts.size() > most)
  {
    throw InputError("The body has " + std::to_string(parts.size()) +
      " parts for FEBio, which differ in their region, their law or a parameter that FEBio takes "
      "as "
      "one number for a material (BulkModulus and OgdenExponent1 to 3); at most " +
      std::to_string(most) + " are written. Let those parameters be the same in more cells.");
  }
  return parts;
}

void WriteMaterial(const Scene& scene, const Part& part, std::size_t number, Output& xml)
{
  xml.Open(
    "material", { { "id", Text(number) }, { "name", part.Name }, { "type", part.Law->Type } });
  for (const vtkPalpateFEBioLaw::Parameter& parameter : part.Law->Parameters)
  {
    const double value = Theirs(MaterialOf(scene, part.Cells.front()), parameter);
    const bool varies =
      std::find(part.Varying.begin(), part.Varying.end(), &parameter) != part.Varying.end();
    if (varies)
    {
      xml.Leaf(parameter.Name, { { "type", "map" } }, part.Name + '_' + parameter.Name);
    }
    // Of a term of Ogden's that is not there, FEBio admits no exponent of 0.
    else if (part.Law->Law != palpate::Law::ogden || value != 0)
    {
      xml.Leaf(parameter.Name, {}, Text(value));
    }
  }
  if (part.Law->IsUncoupled)
  {
    xml.Leaf("pressure_model", {}, vtkPalpateFEBioPressureModel::Number);
  }
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
  WriteNodeSet(vtkPalpateArray::Fixed, scene.fixed, xml);
  WriteNodeSet(vtkPalpateArray::Touchable, scene.touchable, xml);
  xml.Close();
}

void WriteMaps(const Scene& scene, const Part& part, Output& xml)
{
  for (const vtkPalpateFEBioLaw::Parameter* parameter : part.Varying)
  {
    xml.Open("ElementData",
      { { "name", part.Name + '_' + parameter->Name }, { "elem_set", part.Name },
        { "data_type", "scalar" } });
    std::size_t place = 0;
    for (const Index cell : part.Cells)
    {
      xml.Leaf(
        "elem", { { "lid", Text(++place) } }, Text(Theirs(MaterialOf(scene, cell), *parameter)));
    }
    xml.Close();
  }
}

void WriteModel(const Scene& scene, const std::vector<Part>& parts, std::ostream& stream)
{
  Output xml(stream);
  xml.Open("febio_spec", { { "version", "4.0" } });
  xml.Open("Module", { { "type", "solid" } });
  xml.Leaf("units", {}, "SI");
  xml.Close();
  xml.Open("Material");
  for (std::size_t i = 0; i < parts.size(); ++i)
  {
    WriteMaterial(scene, parts[i], i + 1, xml);
  }
  xml.Close();
  WriteMesh(scene, parts, xml);
  xml.Open("MeshDomains");
  for (const Part& part : parts)
  {
    // Of its own FEBio takes the one with a pressure for every uncoupled material.
    const bool hasPressure = part.Law->IsUncoupled && palpate::is_mixed(part.Formulation);
    xml.Empty("SolidDomain",
      { { "name", part.Name }, { "mat", part.Name },
        { "type", hasPressure ? "three-field-solid" : "elastic-solid" } });
  }
  xml.Close();
  if (std::any_of(
        parts.begin(), parts.end(), [](const Part& part) { return !part.Varying.empty(); }))
  {
    xml.Open("MeshData");
    for (const Part& part : parts)
    {
      WriteMaps(scene, part, xml);
    }
    xml.Close();
  }
  xml.Open("Boundary");
  xml.Open("bc",
    { { "name", vtkPalpateArray::Fixed }, { "type", "zero displacement" },
      { "node_set", vtkPalpateArray::Fixed } });
  for (const char* axis : { "x_dof", "y_dof", "z_dof" })
  {
    xml.Leaf(axis, {}, "1");
  }
  xml.Close();
  xml.Close();
  xml.Close();
}

/// The file appears whole or not at all, so that one of that name is not lost.
void WriteFile(const Scene& scene, const std::vector<Part>& parts, const std::string& name)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const bool isDevice = fs::exists(name, error) && !fs::is_regular_file(name, error);
  const std::string written = isDevice ? name : name + ".part";
  const auto fail = [&](const std::string& reason)
  {
    if (!isDevice)
    {
      fs::remove(written, error);
    }
    throw BackendError("The file " + name + " cannot be written: " + reason +
      ". Choose a folder that is there, may be written to and has room.");
  };
  std::ofstream file(written, std::ios::binary);
  if (file)
  {
    WriteModel(scene, parts, file);
    file.close();
  }
  if (!file)
  {
    fail(std::generic_category().message(errno));
  }
  if (!isDevice)
  {
    fs::rename(written, name, error);
    if (error)
    {
      fail(error.message());
    }
  }
}

/// A sentence about each thing that FEBio's file does not say; empty where it says all.
std::string Unsaid(const Scene& scene, const std::vector<Part>& parts)
{
  std::string text;
  const bool locks = std::any_of(parts.begin(), parts.end(),
    [](const Part& part) { return palpate::is_mixed(part.Formulation) && !part.Law->IsUncoupled; });
  if (locks)
  {
    text += "Part of the body is nearly incompressible and of a law that FEBio solves by "
            "displacements alone, which makes it too stiff: the law is the same, FEBio's answer is "
            "not. Mooney-Rivlin and Ogden have elements with a pressure in FEBio too. ";
  }
  if (std::any_of(parts.begin(), parts.end(),
        [](const Part& part) { return part.Formulation == palpate::Formulation::mixed_fine; }))
  {
    text += "Part of the body has the Quadrature Fine, which the file does not say: who reads it "
            "finds the standard one. ";
  }
  if (std::find(scene.touchable.begin(), scene.touchable.end(), 1) == scene.touchable.end())
  {
    text += "No point may be touched, and FEBio has no empty sets: who reads the file finds every "
            "free corner of the surface touchable. ";
  }
  return text;
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
      const Scene scene = vtkPalpateSceneFromGrid(body);
      const std::vector<Part> parts = PartsOf(scene, RegionsOf(body));
      WriteFile(scene, parts, this->FileName);
      const std::string unsaid = Unsaid(scene, parts);
      if (!unsaid.empty())
      {
        vtkWarningMacro(<< unsaid << "The file " << this->FileName << " is written.");
      }
    });
  return 1;
}

void vtkPalpateFEBioWriter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n';
}
