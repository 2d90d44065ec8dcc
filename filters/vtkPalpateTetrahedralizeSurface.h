// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkPalpateTetrahedralizeSurface
 * @brief   fills a closed surface with tetrahedra
 *
 * The surface (any vtkPolyData: triangles, quads, polygons, strips; in the unit of length that Unit
 * says; several disjoint bodies) is checked first: open edges, edges of more than two triangles,
 * opposite normals, triangles without an area, triangles that cross each other. TetGen then meshes
 * it in a program of its own, palpate-tetgen, so that its abort, crash or hang is an error message
 * here.
 *
 * A closed surface within another one is a cavity where its normals point the other way than those
 * of the one around it, and a region of its own where they point the same way. A surface that is
 * inside out as a whole is met as if it were not.
 *
 * Output port 0: the tetrahedra, positively oriented, with straight edges; cell array `Region`
 * (int), the number of the body or region, in the order of the input. Port 1: the faults of the
 * surface as it was given, lines for edges and triangles, with the cell array `SurfaceFault` (int)
 * and the field arrays `FaultName` and `FaultCount`, there also where meshing failed. Both have the
 * field array `Repair` (string): what RepairSurface did.
 *
 * @note Collective. The pieces of all ranks are gathered, TetGen runs on rank 0, whose outputs are
 * whole; those of the other ranks are empty.
 */
#pragma once

#include "PalpateFiltersModule.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkImplicitFunction;
class vtkMultiProcessController;
class vtkPolyData;

class PALPATEFILTERS_EXPORT vtkPalpateTetrahedralizeSurface : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateTetrahedralizeSurface* New();
  vtkTypeMacro(vtkPalpateTetrahedralizeSurface, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ Number of a vtkPalpateUnit: in which the surface has its lengths. All lengths and volumes of
  /// the properties are in m, and so is the body.
  vtkSetMacro(Unit, int);
  vtkGetMacro(Unit, int);
  ///@}

  enum ElementOrders
  {
    Linear = 1,   ///< VTK_TETRA
    Quadratic = 2 ///< VTK_QUADRATIC_TETRA, with points in the middle of straight edges
  };
  vtkSetMacro(ElementOrder, int);
  vtkGetMacro(ElementOrder, int);

  ///@{ Largest ratio of circumscribed radius to shortest edge, ≥ 1; the less, the better shaped.
  vtkSetMacro(MaximumRadiusEdgeRatio, double);
  vtkGetMacro(MaximumRadiusEdgeRatio, double);
  ///@}

  ///@{ Largest volume of a tetrahedron, m³; 0 = no bound.
  vtkSetMacro(MaximumVolume, double);
  vtkGetMacro(MaximumVolume, double);
  ///@}

  ///@{ Whether the triangles of the surface stay as they are, without new points.
  vtkSetMacro(PreserveSurface, bool);
  vtkGetMacro(PreserveSurface, bool);
  vtkBooleanMacro(PreserveSurface, bool);
  ///@}

  ///@{ Whether a surface with faults is mended first.
  vtkSetMacro(RepairSurface, bool);
  vtkGetMacro(RepairSurface, bool);
  vtkBooleanMacro(RepairSurface, bool);
  ///@}

  ///@{ Grid points along the longest side of what has to be sampled anew, 16 to 300.
  vtkSetMacro(RepairResolution, int);
  vtkGetMacro(RepairResolution, int);
  ///@}

  ///@{ Where the function is negative, tetrahedra are no larger than RefineVolume.
  virtual void SetRefineRegion(vtkImplicitFunction* function);
  vtkImplicitFunction* GetRefineRegion() const;
  ///@}

  ///@{ Largest volume of a tetrahedron in RefineRegion, m³; 0 = as elsewhere.
  vtkSetMacro(RefineVolume, double);
  vtkGetMacro(RefineVolume, double);
  ///@}

  ///@{ TetGen is stopped after this time, s; 0 = never.
  vtkSetMacro(TimeOut, double);
  vtkGetMacro(TimeOut, double);
  ///@}

  ///@{ The ranks; by default those of the global controller, which may be none.
  virtual void SetController(vtkMultiProcessController* controller);
  vtkMultiProcessController* GetController() const;
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkPalpateTetrahedralizeSurface();
  ~vtkPalpateTetrahedralizeSurface() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

private:
  vtkPalpateTetrahedralizeSurface(const vtkPalpateTetrahedralizeSurface&) = delete;
  void operator=(const vtkPalpateTetrahedralizeSurface&) = delete;

  void Validate() const;
  void Tetrahedralize(vtkPolyData* input, vtkUnstructuredGrid* body, vtkPolyData* faults);
  void Progress(double fraction);

  int Unit = 0;
  int ElementOrder = Linear;
  double MaximumRadiusEdgeRatio = 1.414;
  double MaximumVolume = 0;
  bool PreserveSurface = false;
  bool RepairSurface = false;
  int RepairResolution = 80;
  vtkSmartPointer<vtkImplicitFunction> RefineRegion;
  double RefineVolume = 0;
  double TimeOut = 600;
  vtkSmartPointer<vtkMultiProcessController> Controller;
};
