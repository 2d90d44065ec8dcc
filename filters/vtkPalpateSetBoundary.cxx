// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSetBoundary.h"

#include <algorithm>

#include "base/error.h"
#include "mesh/touching_pieces.h"
#include "vtkCellData.h"
#include "vtkIdList.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFields.h"
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
using palpate::InputError;

constexpr int FixedSelectionPort = 1;
constexpr int TouchableSelectionPort = 2;

/// How the fixed or the touchable points are chosen.
struct Choice
{
  std::string Name; ///< "Fixed", "Touchable": the names of the properties start with it
  int By;
  vtkImplicitFunction* Region;
  const std::string& Array;
  vtkSelection* Selection;
};

/// @param input Of `cells`: a selection has its ids.
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
        (choice.Name == "Fixed" ? " or 2 (Selection)." : ", 2 (Selection) or 3 (Surface)."));
  }
}

/// The chosen points after points were merged: one of those that are one now was chosen.
std::vector<char> OfMerged(const std::vector<char>& chosen, const palpate::MergedMesh& merged)
{
  std::vector<char> now(merged.before.size(), 0);
  for (std::size_t point = 0; point < chosen.size(); ++point)
  {
    char& here = now[static_cast<std::size_t>(merged.number[point])];
    here = here != 0 || chosen[point] != 0 ? 1 : 0;
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

bool Any(const std::vector<char>& chosen)
{
  return std::find(chosen.begin(), chosen.end(), 1) != chosen.end();
}
}

vtkStandardNewMacro(vtkPalpateSetBoundary);

vtkPalpateSetBoundary::vtkPalpateSetBoundary()
{
  this->SetNumberOfInputPorts(3);
}

vtkPalpateSetBoundary::~vtkPalpateSetBoundary() = default;

void vtkPalpateSetBoundary::SetFixedRegion(vtkImplicitFunction* region)
{
  if (this->FixedRegion != region)
  {
    this->FixedRegion = region;
    this->Modified();
  }
}

void vtkPalpateSetBoundary::SetTouchableRegion(vtkImplicitFunction* region)
{
  if (this->TouchableRegion != region)
  {
    this->TouchableRegion = region;
    this->Modified();
  }
}

void vtkPalpateSetBoundary::SetFixedSelectionConnection(vtkAlgorithmOutput* selection)
{
  this->SetInputConnection(FixedSelectionPort, selection);
}

void vtkPalpateSetBoundary::SetTouchableSelectionConnection(vtkAlgorithmOutput* selection)
{
  this->SetInputConnection(TouchableSelectionPort, selection);
}

vtkMTimeType vtkPalpateSetBoundary::GetMTime()
{
  vtkMTimeType time = this->Superclass::GetMTime();
  for (vtkImplicitFunction* region : { this->FixedRegion.Get(), this->TouchableRegion.Get() })
  {
    time = region ? std::max(time, region->GetMTime()) : time;
  }
  return time;
}

int vtkPalpateSetBoundary::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == FixedSelectionPort || port == TouchableSelectionPort)
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
      palpate::TetMesh mesh = vtkPalpateMeshFromGrid(body);
      palpate::check_and_orient(mesh);
      const std::vector<char> used = palpate::points_in_use(mesh);

      std::vector<char> fixed = ChosenPoints(gathered, cells,
        { "Fixed", this->FixedBy, this->FixedRegion, this->FixedArray,
          vtkSelection::GetData(inputVector[FixedSelectionPort]) });
      std::transform(fixed.begin(), fixed.end(), used.begin(), fixed.begin(),
        [](char chosen, char inUse) { return static_cast<char>(chosen != 0 && inUse != 0); });
      if (!Any(fixed))
      {
        throw InputError("No point of the body is fixed: it would float away. FixedBy is " +
          std::string(this->FixedBy == REGION
              ? "Region: move or enlarge FixedRegion so that it holds some points."
              : this->FixedBy == ARRAY ? "Array: the array has to be 1 at some points."
                                       : "Selection: select some points or cells of the body."));
      }
      if (fixed == used)
      {
        throw InputError("Every point of the body is fixed: nothing can move. Fix fewer points.");
      }

      std::vector<char> chosen;
      if (this->TouchableBy != SURFACE)
      {
        chosen = ChosenPoints(gathered, cells,
          { "Touchable", this->TouchableBy, this->TouchableRegion, this->TouchableArray,
            vtkSelection::GetData(inputVector[TouchableSelectionPort]) });
      }
      const palpate::Pieces pieces = palpate::find_pieces(mesh);
      const palpate::TouchingPieces touching = palpate::find_touching_pieces(mesh, pieces);
      if (this->Merge && touching.num_coincident > 0)
      {
        const palpate::MergedMesh merged = palpate::merge_points(mesh, touching);
        body = Merged(body, merged);
        mesh = merged.mesh;
        fixed = OfMerged(fixed, merged);
        chosen = chosen.empty() ? chosen : OfMerged(chosen, merged);
      }
      std::vector<char> touchable = vtkPalpateTouchableSurface(mesh, fixed);
      if (this->TouchableBy != SURFACE)
      {
        std::transform(touchable.begin(), touchable.end(), chosen.begin(), touchable.begin(),
          [](char surface, char here) { return static_cast<char>(surface != 0 && here != 0); });
      }
      if (!Any(touchable))
      {
        vtkWarningMacro("No point of the body may be touched: none of the chosen ones is a corner "
                        "on its surface that is not fixed.");
      }

      output->ShallowCopy(body);
      if (this->Merge)
      {
        vtkPalpateAddInteger(output, "MergedPoints", touching.num_coincident);
      }
      if (const auto text = palpate::describe(touching, pieces.size(), this->Merge))
      {
        vtkWarningMacro(<< *text);
      }
      vtkPalpateAddChoice(output, vtkPalpateArray::Fixed, fixed);
      vtkPalpateAddChoice(output, vtkPalpateArray::Touchable, touchable);
      vtkPalpateAddBoundaryKinds(output, fixed, touchable);
      if (!cells.LeftOut.empty())
      {
        vtkWarningMacro(<< cells.LeftOut);
      }
    });
  return 1;
}

void vtkPalpateSetBoundary::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FixedBy: " << this->FixedBy << '\n'
     << indent << "TouchableBy: " << this->TouchableBy << '\n'
     << indent << "FixedArray: " << this->FixedArray << '\n'
     << indent << "TouchableArray: " << this->TouchableArray << '\n'
     << indent << "Merge: " << this->Merge << '\n';
}
