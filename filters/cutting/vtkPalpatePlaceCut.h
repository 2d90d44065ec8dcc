// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpatePlaceCut
 * @brief puts the sheet of a cut into the mesh of a body, and opens it up to a stage
 *
 * Input port 0: a body of tetrahedra, linear or quadratic with straight edges, with whatever arrays
 * it has. A scene (vtkPalpateScene.h) stays one: it is held, loaded and touched at the same places.
 * Input port 1: the sheet, any open surface, plane or curved, in m.
 *
 * The mesh is changed near the sheet so that faces of cells lie on it. The cut grows along a
 * coordinate of the sheet, from where that meets the body, in strips that end at fronts: at stage j
 * it is open up to the front j. All stages have the same cells; the points of open faces are there
 * once for each side.
 *
 * Output port 0: the body at the stage, with the arrays of its cells and points, and
 *
 *   `CutStage`    cells, four components: the stage from which on the face opposite to each corner
 *                 is open; 0: it never is
 *   `StageFront`  a field array: how far the cut has come at each stage, from stage 0 on, m
 *   `StageArea`   the same: the area of the sheet that is open, m²
 *   `Stage`       a field array: the stage
 *
 * Output port 1: the faces of the closed mesh on the sheet, with their `CutStage`.
 *
 * @note Collective. The pieces of all ranks are gathered, and rank 0 has the whole output.
 */
#pragma once

#include <string>

#include "PalpateCuttingModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkPolyData;
class vtkUnstructuredGrid;

namespace palpate
{
struct SheetMesh;
struct TetMesh;
}

class PALPATECUTTING_EXPORT vtkPalpatePlaceCut : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpatePlaceCut* New();
  vtkTypeMacro(vtkPalpatePlaceCut, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ The point array of the sheet along which the cut grows, m; "None": CutDirection says it.
  vtkSetStdStringFromCharMacro(FrontArray);
  vtkGetCharFromStdStringMacro(FrontArray);
  ///@}

  ///@{
  /// The direction in which the cut grows; 0: along the longer side of the sheet, towards the
  /// middle of the body.
  vtkSetVector3Macro(CutDirection, double);
  vtkGetVector3Macro(CutDirection, double);
  ///@}

  ///@{ The distance of two fronts, m.
  vtkSetMacro(StageSpacing, double);
  vtkGetMacro(StageSpacing, double);
  ///@}

  ///@{ The longest edge of the cells at the sheet, m, roughly; 0: two and a half StageSpacing.
  vtkSetMacro(CutEdge, double);
  vtkGetMacro(CutEdge, double);
  ///@}

  ///@{ The stage up to which the cut is open; 0: it is closed.
  vtkSetMacro(Stage, int);
  vtkGetMacro(Stage, int);
  ///@}

protected:
  vtkPalpatePlaceCut();
  ~vtkPalpatePlaceCut() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

  /// Puts the sheet into the mesh of a body.
  /// @param cells The straight cells of the body.
  /// @param stage Takes the stage that is given out.
  virtual palpate::SheetMesh PutSheet(
    vtkUnstructuredGrid* body, const palpate::TetMesh& cells, vtkPolyData* sheet, int& stage);

  /// The longest edge of the cells at the sheet, m; 0: as PutSheet() chooses.
  double CutEdge = 0;

private:
  vtkPalpatePlaceCut(const vtkPalpatePlaceCut&) = delete;
  void operator=(const vtkPalpatePlaceCut&) = delete;

  std::string FrontArray = "None";
  double CutDirection[3] = { 0, 0, 0 };
  double StageSpacing = 0.005;
  int Stage = 0;
};
