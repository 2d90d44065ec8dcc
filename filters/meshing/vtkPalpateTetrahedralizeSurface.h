// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkPalpateTetrahedralizeSurface
 * @brief   fills a closed surface, or several that share walls, with tetrahedra
 *
 * The surface (any vtkPolyData: triangles, quads, polygons, strips; in the unit of length that Unit
 * says; several bodies and tissues) is checked first: open edges, edges at which bodies hang
 * together by the edge alone, opposite normals, triangles without an area, triangles that cross
 * each other. TetGen then meshes it in a program of its own, palpate-tetgen, so that its abort,
 * crash or hang is an error message here.
 *
 * Surfaces may share walls, there once or twice, with the same triangles or others: tissues beside
 * each other become regions of one body, which share the points of the wall. A closed surface
 * within another one is a cavity where its normals point the other way than those of the one around
 * it, and a region of its own where they point the same way. A surface that is inside out as a
 * whole is met as if it were not.
 *
 * Input port 0, repeatable: surfaces, or collections of surfaces. Several of them, or the cell
 * array RegionArray of a single one, say which triangles bound which tissue.
 *
 * Output port 0: the tetrahedra, positively oriented, with straight edges; cell array `Region`
 * (int): the number of the input or block, or the value of RegionArray, or else the number of the
 * body or region, in the order of the input; field arrays `RegionNumber` (int), `RegionVolume` (m³)
 * and, where blocks have names, `RegionName` with a value for each region. Port 1: the faults of
 * the surface as it was given, lines for edges and triangles, with the cell array `SurfaceFault`
 * (int) and the field arrays `FaultName` and `FaultCount`, there also where meshing failed. Both
 * have the field array `Repair` (string): what RepairSurface did.
 *
 * @note Collective. The pieces of all ranks are gathered, TetGen runs on rank 0, whose outputs are
 * whole; those of the other ranks are empty.
 */
#pragma once

#include <optional>

#include "PalpateMeshingModule.h"
#include "vtkPalpateTetrahedralize.h"

class vtkImplicitFunction;
class vtkPolyData;
struct vtkPalpateCompartments;
struct vtkPalpateRepairOptions;
struct vtkPalpateRepairedSurface;
struct vtkPalpateSurface;
struct vtkPalpateSurfaceFaults;
struct vtkPalpateTissueSurfaces;
struct vtkPalpateWalls;

class PALPATEMESHING_EXPORT vtkPalpateTetrahedralizeSurface : public vtkPalpateTetrahedralize
{
public:
  static vtkPalpateTetrahedralizeSurface* New();
  vtkTypeMacro(vtkPalpateTetrahedralizeSurface, vtkPalpateTetrahedralize);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ Largest volume of a tetrahedron, m³; 0 = no bound.
  vtkSetMacro(MaximumVolume, double);
  vtkGetMacro(MaximumVolume, double);
  ///@}

  ///@{ Whether the triangles of the surface stay as they are, without new points.
  vtkSetMacro(PreserveSurface, bool);
  vtkGetMacro(PreserveSurface, bool);
  vtkBooleanMacro(PreserveSurface, bool);
  ///@}

  ///@{ The cell array of a single surface with the number of the region that each triangle bounds;
  /// "Automatic": `Region`, where there is one; "None": none.
  vtkSetStdStringFromCharMacro(RegionArray);
  vtkGetCharFromStdStringMacro(RegionArray);
  ///@}

  ///@{
  /// The largest distance of the walls of two tissues that are taken for one wall, m; 0 = only
  /// rounding.
  vtkSetMacro(WallTolerance, double);
  vtkGetMacro(WallTolerance, double);
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

  ///@{ Largest volume of a tetrahedron in RefineRegion, m³; 0 = as elsewhere.
  vtkSetMacro(RefineVolume, double);
  vtkGetMacro(RefineVolume, double);
  ///@}

  ///@{
  /// A point array of the surfaces: how long edges of tetrahedra may be there, m, and by EdgeGrowth
  /// longer in a metre of distance; where it is 0, nothing is asked. "None": there is none.
  vtkSetStdStringFromCharMacro(EdgeArray);
  vtkGetCharFromStdStringMacro(EdgeArray);
  ///@}

protected:
  vtkPalpateTetrahedralizeSurface();
  ~vtkPalpateTetrahedralizeSurface() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

  bool UsesRefineRegion() const override
  {
    return this->RefineVolume > 0 || this->Superclass::UsesRefineRegion();
  }
  std::string MakeEstimate() override;
  void Validate() const override;

private:
  vtkPalpateTetrahedralizeSurface(const vtkPalpateTetrahedralizeSurface&) = delete;
  void operator=(const vtkPalpateTetrahedralizeSurface&) = delete;

  /// @param edges What EdgeArray asks for.
  void Tetrahedralize(const vtkPalpateTissueSurfaces& tissues, const vtkPalpateEdges& edges,
    vtkUnstructuredGrid* body, vtkPolyData* faults);
  /// What EdgeArray and RefineEdge ask for, on rank 0. @note Collective.
  /// @throws palpate::InputError no surface has the array.
  vtkPalpateEdges EdgesOf(const std::vector<vtkDataObject*>& inputs) const;
  vtkPalpateSurface SurfaceOf(vtkPolyData* input) const;
  /// The surfaces with one triangulation for each wall that two of them share; nothing if there is
  /// no such wall.
  std::optional<vtkPalpateRepairedSurface> MatchWalls(const vtkPalpateSurface& surface,
    const vtkPalpateWalls& walls, const vtkPalpateCompartments& compartments,
    const vtkPalpateSurfaceFaults& faults) const;
  vtkPalpateRepairOptions RepairOptions();
  void Mesh(const vtkPalpateSurface& given, vtkPalpateRepairedSurface& repaired,
    const vtkPalpateTissueSurfaces& tissues, const vtkPalpateEdges& edges,
    vtkUnstructuredGrid* body);
  /// @param volume The volume of the body, m³.
  /// @throws palpate::InputError with MaximumVolume there would be far too many tetrahedra.
  void RequireFewEnough(double volume) const;
  /// The approximate number of tetrahedra that the mesher will make.
  double CountTetrahedra(const vtkPalpateSurface& surface) const;

  double MaximumVolume = 0;
  bool PreserveSurface = false;
  std::string RegionArray = "Automatic";
  double WallTolerance = 0;
  bool RepairSurface = false;
  int RepairResolution = 80;
  double RefineVolume = 0;
  std::string EdgeArray = "None";
};
