// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkPalpateTetrahedralizeLabelMap
 * @brief makes one body of tetrahedra from a segmented image
 *
 * The image has a whole number for each voxel (an array of its points or cells), the label of the
 * tissue there; 0 is not part of the body, nor are negative ones unless they are named. The walls
 * between unlike voxels are smoothed and bound the tetrahedra, so that tissues share the points of
 * the walls between them. Each connected part of a label keeps its volume, or is named in a
 * warning.
 *
 * Output port 0: the tetrahedra, positively oriented, with straight edges, in m; cell array
 * `RegionId` (int), the label, and `Part` (int), the connected part of a label; field arrays
 * `Label` (int), `LabelName` (string; only where the image has names, see
 * vtkPalpateSegmentationReader), `ImageVolume` and `MeshVolume` (m³) with a value for each label,
 * `PartLabel`
 * (int), `PartImageVolume`, `PartMeshVolume` (m³; 0: it is lost) and `PartCentre` (m, 3 components,
 * in the image) with one for each part, and `Report` (string), what was done and how good it is.
 * Port 1: the walls, with the cell array `BoundaryLabels` (2 components: the labels behind the wall
 * and in front of it).
 *
 * @note Collective. The image of rank 0 is taken, which has to be whole there; the outputs of the
 * other ranks are empty.
 */
#pragma once

#include <map>
#include <vector>

#include "PalpateMeshingModule.h"
#include "vtkPalpateTetrahedralize.h"

class vtkImageData;
class vtkPolyData;
struct vtkPalpateCubes;
struct vtkPalpateLabelGrid;
struct vtkPalpateLabelParts;

class PALPATEMESHING_EXPORT vtkPalpateTetrahedralizeLabelMap : public vtkPalpateTetrahedralize
{
public:
  static vtkPalpateTetrahedralizeLabelMap* New();
  vtkTypeMacro(vtkPalpateTetrahedralizeLabelMap, vtkPalpateTetrahedralize);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{ The array of labels; "None" or empty: the active scalars.
  vtkSetStdStringFromCharMacro(LabelArray);
  vtkGetCharFromStdStringMacro(LabelArray);
  ///@}

  ///@{ The labels that are tissues of the body; none = all but 0.
  void AddLabel(int label);
  void ClearLabels();
  ///@}

  ///@{
  /// Edge of the tetrahedra, m; 0 = an edge that gives some ten thousand of them.
  vtkSetMacro(ElementSize, double);
  vtkGetMacro(ElementSize, double);
  ///@}

  ///@{ The same for single labels: label and edge (m).
  void AddLabelSize(double label, double size);
  void ClearLabelSizes();
  ///@}

  ///@{
  /// Number of steps in which the walls are smoothed; 0 = the walls are the faces of voxels.
  vtkSetMacro(Smoothing, int);
  vtkGetMacro(Smoothing, int);
  ///@}

  ///@{ Connected parts of a label below this volume (m³) are given to the label around them.
  vtkSetMacro(SmallestIsland, double);
  vtkGetMacro(SmallestIsland, double);
  ///@}

  ///@{
  /// Whether the cavities that the body encloses are given to the label around them.
  vtkSetMacro(FillHoles, bool);
  vtkGetMacro(FillHoles, bool);
  vtkBooleanMacro(FillHoles, bool);
  ///@}

protected:
  vtkPalpateTetrahedralizeLabelMap();
  ~vtkPalpateTetrahedralizeLabelMap() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;
  int RequestData(
    vtkInformation* request, vtkInformationVector** input, vtkInformationVector* output) override;

  std::string MakeEstimate() override;
  void Validate() const override;

private:
  vtkPalpateTetrahedralizeLabelMap(const vtkPalpateTetrahedralizeLabelMap&) = delete;
  void operator=(const vtkPalpateTetrahedralizeLabelMap&) = delete;

  void Tetrahedralize(vtkImageData* image, vtkUnstructuredGrid* body, vtkPolyData* walls);
  /// @param negative See vtkPalpateReadLabels.
  vtkPalpateLabelGrid ReadLabels(vtkImageData* image, std::map<int, std::size_t>* negative) const;
  double UnitOf(vtkImageData* image) const;
  /// The edge of the tetrahedra of each label, m.
  std::map<int, double> Sizes(
    const std::map<int, double>& volumes, const vtkPalpateLabelGrid& grid) const;
  /// The number of tetrahedra that these edges ask for.
  /// @throws palpate::InputError it is above the largest one.
  double CountTetrahedra(
    const std::map<int, double>& volumes, const std::map<int, double>& sizes) const;
  /// Samples the parts on cubes with the least of these edges. If the edges are automatic and a
  /// label vanishes, they become smaller.
  vtkPalpateCubes Resample(const vtkPalpateLabelParts& parts, const std::map<int, double>& volumes,
    std::map<int, double>& sizes) const;

  std::string LabelArray = "None";
  std::vector<int> Labels;
  double ElementSize = 0;
  std::vector<std::pair<double, double>> LabelSizes;
  int Smoothing = 20;
  double SmallestIsland = 0;
  bool FillHoles = false;
};
