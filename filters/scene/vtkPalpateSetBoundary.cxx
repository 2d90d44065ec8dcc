// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSetBoundary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "assembly/loaded_faces.h"
#include "assembly/supports.h"
#include "base/error.h"
#include "base/quantity.h"
#include "mesh/touching_pieces.h"
#include "soft_contact/contact_defaults.h"
#include "vtkCellData.h"
#include "vtkIdList.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateArrayCheck.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpatePointChoice.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSelection.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Index;
using palpate::InputError;
using palpate::Vec3;

constexpr int FixedSelectionPort = 1;
constexpr int TouchableSelectionPort = 2;
constexpr int LoadSelectionPort = 3;

/// How the held, the touchable or the loaded points are chosen.
struct Choice
{
  std::string Name; ///< "Fixed", "Touchable", "Load": the names of the properties start with it
  int By;
  vtkImplicitFunction* Region;
  const std::string& Array;
  vtkSelection* Selection;
};

/// @param input The input of `cells`, whose ids a selection has.
std::vector<char> ChosenPoints(
  vtkUnstructuredGrid* input, const vtkPalpateBodyCells& cells, const Choice& choice)
{
  vtkUnstructuredGrid* body = cells.Body;
  switch (choice.By)
  {
    case vtkPalpateSetBoundary::REGION:
      if (!choice.Region)
      {
        throw InputError(choice.Name + "By is Region, but " + choice.Name +
          "Region is not set. Set it to a box, sphere, plane or cylinder.");
      }
      return vtkPalpatePointsOfRegion(body, choice.Region);
    case vtkPalpateSetBoundary::ARRAY:
      return vtkPalpatePointsOfArray(body, choice.Array, choice.Name + "Array");
    case vtkPalpateSetBoundary::SELECTION:
      if (!choice.Selection)
      {
        throw InputError(choice.Name + "By is Selection, but " + choice.Name +
          "Selection is not set. Select points or cells of the body and press Copy Active "
          "Selection.");
      }
      return vtkPalpateExtendChoice(cells, vtkPalpatePointsOfSelection(input, choice.Selection));
    default:
      throw InputError(choice.Name + "By is " + std::to_string(choice.By) +
        "; it must be 0 (Region), 1 (Array)" +
        (choice.Name == "Fixed"          ? " or 2 (Selection)."
            : choice.Name == "Touchable" ? ", 2 (Selection) or 3 (Surface)."
                                         : ", 2 (Selection), 3 (Surface) or 4 (Cavities)."));
  }
}

bool IsNone(double value)
{
  return value == 0;
}
bool IsNone(const Vec3& value)
{
  return value.isZero(0);
}

/// Values of points after points were merged: each point has the first value of its points that is
/// not 0, so that it is chosen if one of them was. Empty stays empty.
template <class Value>
std::vector<Value> OfMerged(const std::vector<Value>& values, const palpate::MergedMesh& merged)
{
  std::vector<Value> now;
  if (values.empty())
  {
    return now;
  }
  for (const Index before : merged.before)
  {
    now.push_back(values[static_cast<std::size_t>(before)]);
  }
  for (std::size_t point = 0; point < values.size(); ++point)
  {
    Value& here = now[static_cast<std::size_t>(merged.number[point])];
    if (IsNone(here))
    {
      here = values[point];
    }
  }
  return now;
}

/// The supports and loads of the body after points were merged: a point is held along all
/// directions of the points that were merged to it.
palpate::Scene OfMerged(const palpate::Scene& scene, const palpate::MergedMesh& merged)
{
  palpate::Scene now;
  now.organ = scene.organ;
  now.body.mesh = merged.mesh;
  now.body.part_of_cell = scene.body.part_of_cell;
  now.body.fixed = OfMerged(scene.body.fixed, merged);
  now.body.support_stiffness = OfMerged(scene.body.support_stiffness, merged);
  now.body.applied_pressure = OfMerged(scene.body.applied_pressure, merged);
  now.body.applied_traction = OfMerged(scene.body.applied_traction, merged);
  if (scene.body.held_directions.empty())
  {
    return now;
  }
  now.body.held_directions.assign(merged.before.size(), palpate::HeldDirections::Zero());
  for (std::size_t point = 0; point < scene.body.held_directions.size(); ++point)
  {
    const auto here = static_cast<std::size_t>(merged.number[point]);
    for (const Vec3 direction : scene.body.held_directions[point].colwise())
    {
      if (!direction.isZero(0))
      {
        palpate::hold_along(direction, now.body.held_directions[here], now.body.fixed[here]);
      }
    }
  }
  return now;
}

/// The body with points merged: each has the values of the first of them.
vtkSmartPointer<vtkUnstructuredGrid> Merged(
  vtkUnstructuredGrid* body, const palpate::MergedMesh& merged)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  const auto numberOfPoints = static_cast<vtkIdType>(merged.before.size());
  vtkNew<vtkPoints> points;
  points->SetDataType(body->GetPoints()->GetDataType());
  points->SetNumberOfPoints(numberOfPoints);
  vtkPointData* values = grid->GetPointData();
  values->CopyAllOn();
  values->CopyAllocate(body->GetPointData(), numberOfPoints);
  for (vtkIdType point = 0; point < numberOfPoints; ++point)
  {
    const palpate::Index before = merged.before[static_cast<std::size_t>(point)];
    points->SetPoint(point, body->GetPoint(before));
    values->CopyData(body->GetPointData(), before, point);
  }
  grid->SetPoints(points);
  grid->Allocate(body->GetNumberOfCells());
  vtkNew<vtkIdList> nodes;
  for (vtkIdType cell = 0; cell < body->GetNumberOfCells(); ++cell)
  {
    body->GetCellPoints(cell, nodes);
    for (vtkIdType& node : *nodes)
    {
      node = merged.number[static_cast<std::size_t>(node)];
    }
    grid->InsertNextCell(body->GetCellType(cell), nodes);
  }
  grid->GetCellData()->ShallowCopy(body->GetCellData());
  grid->GetFieldData()->ShallowCopy(body->GetFieldData());
  return grid;
}

/// The faces of the surface whose corners are all chosen.
std::vector<Index> FacesOf(const palpate::TetMesh& mesh, const std::vector<char>& chosen)
{
  return palpate::faces_where(mesh,
    [&](const Index* c) { return chosen[c[0]] != 0 && chosen[c[1]] != 0 && chosen[c[2]] != 0; });
}

bool Any(const std::vector<char>& chosen)
{
  return std::find(chosen.begin(), chosen.end(), 1) != chosen.end();
}
}

vtkStandardNewMacro(vtkPalpateSetBoundary);

vtkPalpateSetBoundary::vtkPalpateSetBoundary()
{
  this->SetNumberOfInputPorts(4);
}

vtkPalpateSetBoundary::~vtkPalpateSetBoundary() = default;

void vtkPalpateSetBoundary::SetRegion(
  vtkSmartPointer<vtkImplicitFunction>& region, vtkImplicitFunction* to)
{
  if (region != to)
  {
    region = to;
    this->Modified();
  }
}

void vtkPalpateSetBoundary::SetFixedRegion(vtkImplicitFunction* region)
{
  this->SetRegion(this->FixedRegion, region);
}

void vtkPalpateSetBoundary::SetTouchableRegion(vtkImplicitFunction* region)
{
  this->SetRegion(this->TouchableRegion, region);
}

void vtkPalpateSetBoundary::SetLoadRegion(vtkImplicitFunction* region)
{
  this->SetRegion(this->LoadRegion, region);
}

void vtkPalpateSetBoundary::SetFixedSelectionConnection(vtkAlgorithmOutput* selection)
{
  this->SetInputConnection(FixedSelectionPort, selection);
}

void vtkPalpateSetBoundary::SetTouchableSelectionConnection(vtkAlgorithmOutput* selection)
{
  this->SetInputConnection(TouchableSelectionPort, selection);
}

void vtkPalpateSetBoundary::SetLoadSelectionConnection(vtkAlgorithmOutput* selection)
{
  this->SetInputConnection(LoadSelectionPort, selection);
}

vtkMTimeType vtkPalpateSetBoundary::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  for (vtkImplicitFunction* region :
    { this->FixedRegion.Get(), this->TouchableRegion.Get(), this->LoadRegion.Get() })
  {
    time = region ? std::max(time, region->GetMTime()) : time;
  }
  return time;
}

int vtkPalpateSetBoundary::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == FixedSelectionPort || port == TouchableSelectionPort || port == LoadSelectionPort)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkSelection");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
    return 1;
  }
  vtkPalpateTakeWhole(info, "vtkUnstructuredGrid");
  return 1;
}

int vtkPalpateSetBoundary::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      const auto gathered =
        vtkPalpateGatherBody(vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
      if (!gathered || vtkPalpatePassFailure(gathered, output))
      {
        return;
      }
      const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(gathered);
      vtkSmartPointer<vtkUnstructuredGrid> body = cells.Body;
      const auto selectionOf = [&](int port) { return vtkSelection::GetData(inputVector[port]); };
      std::vector<char> held;
      if (this->Support != NOTHING)
      {
        held = ChosenPoints(gathered, cells,
          { "Fixed", this->FixedBy, this->FixedRegion, this->FixedArray,
            selectionOf(FixedSelectionPort) });
      }
      std::vector<char> loaded;
      if (this->Load != NO_LOAD && this->LoadBy != SURFACE && this->LoadBy != CAVITIES)
      {
        loaded = ChosenPoints(gathered, cells,
          { "Load", this->LoadBy, this->LoadRegion, this->LoadArray,
            selectionOf(LoadSelectionPort) });
      }
      std::vector<char> touched;
      if (this->TouchableBy != SURFACE)
      {
        touched = ChosenPoints(gathered, cells,
          { "Touchable", this->TouchableBy, this->TouchableRegion, this->TouchableArray,
            selectionOf(TouchableSelectionPort) });
      }

      palpate::Scene scene = this->SceneBefore(body);
      const palpate::Pieces pieces = palpate::find_pieces(scene.body.mesh);
      const palpate::TouchingPieces touching =
        palpate::find_touching_pieces(scene.body.mesh, pieces);
      if (this->Merge && touching.num_coincident > 0)
      {
        const palpate::MergedMesh merged = palpate::merge_points(scene.body.mesh, touching);
        body = Merged(body, merged);
        scene = OfMerged(scene, merged);
        held = OfMerged(held, merged);
        loaded = OfMerged(loaded, merged);
        touched = OfMerged(touched, merged);
      }
      if (this->Support != NOTHING)
      {
        this->Hold(held, scene);
      }
      double area = 0;
      if (this->Load != NO_LOAD)
      {
        area = this->LoadFaces(this->LoadBy == SURFACE ? palpate::boundary_points(scene.body.mesh)
            : this->LoadBy == CAVITIES ? palpate::points_of_cavities(scene.body.mesh)
                                       : loaded,
          scene);
      }
      if (this->Contact != NO_CONTACT)
      {
        this->Touch(body, scene);
      }
      scene.body.touchable =
        vtkPalpateTouchableSurface(scene.body.mesh, vtkPalpateHeldPoints(scene));
      if (this->TouchableBy != SURFACE)
      {
        std::transform(scene.body.touchable.begin(), scene.body.touchable.end(), touched.begin(),
          scene.body.touchable.begin(),
          [](char surface, char here) { return static_cast<char>(surface != 0 && here != 0); });
      }
      if (!Any(scene.body.touchable))
      {
        vtkWarningMacro("No point of the body may be touched: none of the chosen ones is a corner "
                        "on its surface that is neither fixed nor held along a direction.");
      }

      output->ShallowCopy(body);
      if (this->Merge)
      {
        vtkPalpateAddInteger(output, "MergedPoints", touching.num_coincident);
      }
      const auto text = palpate::describe(touching, pieces.size(), this->Merge);
      if (text && scene.organ.touching == palpate::TouchingParts::none)
      {
        vtkPalpateWarn(this, *text);
      }
      vtkPalpateAddChoice(output, vtkPalpateArray::Fixed, scene.body.fixed);
      vtkPalpateAddChoice(output, vtkPalpateArray::Touchable, scene.body.touchable);
      vtkPalpateAddBoundaryKinds(scene, output);
      vtkPalpateWriteBoundary(scene, output);
      if (this->Load != NO_LOAD)
      {
        vtkPalpateAddNumber(output, "LoadedArea", area);
      }
      if (!cells.LeftOut.empty())
      {
        vtkPalpateWarn(this, cells.LeftOut);
      }
    });
  return 1;
}

palpate::Scene vtkPalpateSetBoundary::SceneBefore(vtkUnstructuredGrid* body) const
{
  palpate::Scene scene;
  scene.body.mesh = vtkPalpateMeshFromGrid(body);
  palpate::check_and_orient(scene.body.mesh);
  vtkPalpateReadBoundary(body, scene);
  vtkDataArray* fixed = vtkPalpateScalarArray(body->GetPointData(), vtkPalpateArray::Fixed);
  // Where points are held along directions, fixed points may be held along three of them.
  scene.body.fixed = fixed && (this->Support != FIXED || scene.body.has_supports())
    ? vtkPalpateChosenPoints(fixed)
    : std::vector<char>(scene.body.mesh.points.size(), 0);
  return scene;
}

void vtkPalpateSetBoundary::Hold(const std::vector<char>& points, palpate::Scene& scene) const
{
  const std::vector<char> used = palpate::points_in_use(scene.body.mesh);
  std::vector<char> chosen = points;
  std::transform(chosen.begin(), chosen.end(), used.begin(), chosen.begin(),
    [](char isChosen, char inUse) { return static_cast<char>(isChosen != 0 && inUse != 0); });
  if (!Any(chosen))
  {
    throw InputError("No point of the body is " +
      std::string(this->Support == FIXED ? "fixed: it would float away." : "held.") +
      " FixedBy is " +
      std::string(this->FixedBy == REGION
          ? "Region: move or enlarge FixedRegion so that it holds some points."
          : this->FixedBy == ARRAY ? "Array: the array has to be 1 at some points."
                                   : "Selection: select some points or cells of the body."));
  }
  const Vec3 direction(this->HeldDirection);
  switch (this->Support)
  {
    case FIXED:
      std::transform(chosen.begin(), chosen.end(), scene.body.fixed.begin(),
        scene.body.fixed.begin(),
        [](char isChosen, char isFixed) { return static_cast<char>(isChosen | isFixed); });
      if (scene.body.fixed == used)
      {
        throw InputError("Every point of the body is fixed: nothing can move. Fix fewer points.");
      }
      return;
    case DIRECTION:
      if (!direction.allFinite() || direction.isZero(0))
      {
        throw InputError("HeldDirection is not a direction. Give three numbers that are not all 0, "
                         "as (0, 0, 1) to hold points along z.");
      }
      break;
    case NORMAL:
      break;
    case SPRINGS:
      if (!(this->SupportStiffness > 0) || !std::isfinite(this->SupportStiffness))
      {
        throw InputError("SupportStiffness is " + palpate::quantity(this->SupportStiffness) +
          "; give a number above 0, N/m³.");
      }
      scene.body.support_stiffness.resize(chosen.size(), 0);
      for (std::size_t point = 0; point < chosen.size(); ++point)
      {
        if (chosen[point] != 0)
        {
          scene.body.support_stiffness[point] = this->SupportStiffness;
        }
      }
      if (palpate::faces_with(scene.body.mesh, scene.body.support_stiffness).empty())
      {
        throw InputError("No face of the surface has all of its corners at the points that FixedBy "
                         "chooses, so that no spring holds it. Choose the points of whole faces.");
      }
      return;
    default:
      throw InputError("Support is " + std::to_string(this->Support) +
        "; it must be 0 (Fixed), 1 (Direction), 2 (Normal), 3 (Springs) or 4 (Nothing).");
  }
  const std::vector<Vec3> normals = this->Support == NORMAL
    ? palpate::normals_at(scene.body.mesh, FacesOf(scene.body.mesh, chosen))
    : std::vector<Vec3>(chosen.size(), direction);
  bool any = false;
  scene.body.held_directions.resize(chosen.size(), palpate::HeldDirections::Zero());
  for (std::size_t point = 0; point < chosen.size(); ++point)
  {
    if (chosen[point] != 0 && !normals[point].isZero(0))
    {
      palpate::hold_along(
        normals[point], scene.body.held_directions[point], scene.body.fixed[point]);
      any = true;
    }
  }
  if (!any)
  {
    throw InputError("No face of the surface has all of its corners at the points that FixedBy "
                     "chooses, so that there is no normal to hold them along. Choose the points of "
                     "whole faces, or give a HeldDirection.");
  }
}

void vtkPalpateSetBoundary::Touch(vtkUnstructuredGrid* body, palpate::Scene& scene) const
{
  if (this->Contact < BETWEEN_PARTS || this->Contact > BETWEEN_SIDES_OF_A_CUT)
  {
    throw InputError("Contact is " + std::to_string(this->Contact) +
      "; it must be 0 (None), 1 (Between Parts), 2 (Also With Themselves) or 3 (Between Sides Of A "
      "Cut).");
  }
  if (this->Contact == BETWEEN_SIDES_OF_A_CUT && scene.body.cut.faces.empty())
  {
    throw InputError("Contact is Between Sides Of A Cut, but the body has no cut. Apply Place Cut "
                     "to it before, or choose another Contact.");
  }
  for (const auto& [name, value] : { std::pair{ "ContactThickness", this->ContactThickness },
         std::pair{ "ContactStiffness", this->ContactStiffness } })
  {
    if (!std::isfinite(value) || value < 0)
    {
      throw InputError(std::string(name) + " is " + palpate::quantity(value) +
        "; give a number above 0, or 0 for a usual one.");
    }
  }
  std::vector<Index>& parts = scene.body.part_of_cell;
  if (this->Contact == BETWEEN_SIDES_OF_A_CUT)
  {
    parts.clear();
  }
  else if (this->PartsBy == PIECES)
  {
    parts = palpate::find_pieces(scene.body.mesh).of_cell;
  }
  else if (this->PartsBy == PART_ARRAY)
  {
    parts.resize(static_cast<std::size_t>(scene.body.mesh.num_cells()));
    vtkDataArray* array = vtkPalpateScalarArray(body->GetCellData(), this->PartArray.c_str());
    if (!array)
    {
      throw InputError("PartsBy is Array, but the body has no cell array of one component that is "
                       "called \"" +
        this->PartArray + "\". Choose one as PartArray, or Pieces as PartsBy.");
    }
    std::map<double, Index> numbers;
    for (std::size_t cell = 0; cell < parts.size(); ++cell)
    {
      numbers.emplace(array->GetComponent(static_cast<vtkIdType>(cell), 0), 0);
    }
    Index next = 0;
    for (auto& [value, number] : numbers)
    {
      number = next++;
    }
    for (std::size_t cell = 0; cell < parts.size(); ++cell)
    {
      parts[cell] = numbers.at(array->GetComponent(static_cast<vtkIdType>(cell), 0));
    }
  }
  else
  {
    throw InputError(
      "PartsBy is " + std::to_string(this->PartsBy) + "; it must be 0 (Pieces) or 1 (Array).");
  }
  if (this->Contact == BETWEEN_PARTS && *std::max_element(parts.begin(), parts.end()) == 0)
  {
    throw InputError(std::string("Contact is Between Parts, but there is one part only: ") +
      (this->PartsBy == PIECES ? "the body is in one piece. Choose an array as PartsBy"
                               : "PartArray has one value. Choose another array") +
      ", or Also With Themselves as Contact.");
  }
  scene.organ.touching = static_cast<palpate::TouchingParts>(this->Contact);
  scene.organ.contact.thickness =
    this->ContactThickness > 0 ? this->ContactThickness : palpate::usual_contact_thickness(scene);
  scene.organ.contact.stiffness = this->ContactStiffness;
}

double vtkPalpateSetBoundary::LoadFaces(
  const std::vector<char>& chosen, palpate::Scene& scene) const
{
  const Vec3 traction(this->AppliedTraction);
  const bool isPressure = this->Load == PRESSURE;
  if (!isPressure && this->Load != TRACTION)
  {
    throw InputError("Load is " + std::to_string(this->Load) +
      "; it must be 0 (None), 1 (Pressure) or 2 (Traction).");
  }
  if (isPressure ? !std::isfinite(this->AppliedPressure) || this->AppliedPressure == 0
                 : !traction.allFinite() || traction.isZero(0))
  {
    throw InputError(std::string(isPressure ? "AppliedPressure" : "AppliedTraction") +
      " is 0 or no number. Give one in Pa, or None as Load.");
  }
  const std::vector<Index> faces = FacesOf(scene.body.mesh, chosen);
  if (faces.empty())
  {
    throw InputError(this->LoadBy == CAVITIES
        ? "The body has no closed cavity. Choose the surface that is loaded by Region, Array or "
          "Selection (LoadBy)."
        : "No face of the surface has all of its corners at the points that LoadBy chooses, so "
          "that "
          "nothing is loaded. Choose the points of whole faces.");
  }
  if (isPressure)
  {
    scene.body.applied_pressure.resize(chosen.size(), 0);
  }
  else
  {
    scene.body.applied_traction.resize(chosen.size(), Vec3::Zero());
  }
  for (const Index point : faces)
  {
    if (isPressure)
    {
      scene.body.applied_pressure[point] = this->AppliedPressure;
    }
    else
    {
      scene.body.applied_traction[point] = traction;
    }
  }
  // The area includes the faces that were loaded before.
  return palpate::area_of(scene.body.mesh,
    isPressure ? palpate::faces_under_pressure(scene.body.mesh, scene.body.applied_pressure)
               : palpate::faces_with(scene.body.mesh, scene.body.applied_traction));
}

void vtkPalpateSetBoundary::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FixedBy: " << this->FixedBy << '\n'
     << indent << "TouchableBy: " << this->TouchableBy << '\n'
     << indent << "FixedArray: " << this->FixedArray << '\n'
     << indent << "TouchableArray: " << this->TouchableArray << '\n'
     << indent << "Merge: " << this->Merge << '\n'
     << indent << "Contact: " << this->Contact << '\n'
     << indent << "PartsBy: " << this->PartsBy << '\n'
     << indent << "PartArray: " << this->PartArray << '\n'
     << indent << "ContactThickness: " << this->ContactThickness << " m\n"
     << indent << "ContactStiffness: " << this->ContactStiffness << " Pa\n"
     << indent << "Support: " << this->Support << '\n'
     << indent << "HeldDirection: " << Vec3(this->HeldDirection).transpose() << '\n'
     << indent << "SupportStiffness: " << this->SupportStiffness << " N/m^3\n"
     << indent << "Load: " << this->Load << '\n'
     << indent << "LoadBy: " << this->LoadBy << '\n'
     << indent << "LoadArray: " << this->LoadArray << '\n'
     << indent << "AppliedPressure: " << this->AppliedPressure << " Pa\n"
     << indent << "AppliedTraction: " << Vec3(this->AppliedTraction).transpose() << " Pa\n";
}
