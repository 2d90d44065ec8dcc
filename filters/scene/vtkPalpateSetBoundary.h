// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateSetBoundary
 * @brief says where a body is held, what loads it, and where it may be touched
 *
 * Adds the point arrays `Fixed` and `Touchable` (1 or 0) to the body. The chosen points become
 * fixed, midside nodes too. Of the points that are chosen to be touchable, those that are corners
 * on the surface and not fixed become touchable.
 *
 * By `Support` the chosen points are held along a direction or by springs instead, and by `Load`
 * the surface bears a pressure or a traction: in the point arrays of vtkPalpateScene.h. Arrays of
 * these that the input has are kept, and so is `Fixed` if the chosen points are held otherwise.
 *
 * By `Contact` parts of the body touch each other: the cell array `ContactPart` and the field array
 * `PartContact` say so.
 *
 * If a body is in several pieces, a warning names those that touch without sharing points, since
 * nothing joins them. Those points are merged where that is asked for; then the field array
 * `MergedPoints` says how many were taken away, and points have other ids than in the input.
 *
 * Input ports 1, 2 and 3 are the selections of held, of touchable and of loaded points, all
 * optional. Of selected cells all points are chosen.
 */
#pragma once

#include <string>
#include <vector>

#include "PalpateSceneModule.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGridAlgorithm.h"

class vtkImplicitFunction;
class vtkSelection;

namespace palpate
{
struct Scene;
}

class PALPATESCENE_EXPORT vtkPalpateSetBoundary : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateSetBoundary* New();
  vtkTypeMacro(vtkPalpateSetBoundary, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// The ways to choose points.
  enum Chooser
  {
    REGION = 0,    ///< where an implicit function is not positive
    ARRAY = 1,     ///< where a point array is not 0
    SELECTION = 2, ///< a selection
    SURFACE = 3,   ///< the whole surface; not for held points
    CAVITIES = 4   ///< the surfaces of closed cavities; loaded points alone
  };

  /// The ways to hold the points that `FixedBy` chooses.
  enum Holder
  {
    FIXED = 0,     ///< u = 0
    DIRECTION = 1, ///< u is 0 along `HeldDirection`
    NORMAL = 2,    ///< u is 0 along the surface's normal
    SPRINGS = 3,   ///< springs of `SupportStiffness`
    NOTHING = 4    ///< nothing is chosen
  };

  /// The ways to load the points that `LoadBy` chooses.
  enum Loader
  {
    NO_LOAD = 0,
    PRESSURE = 1,
    TRACTION = 2
  };

  /// Which parts of the body touch each other.
  enum Toucher
  {
    NO_CONTACT = 0,            ///< what earlier filters have set is kept
    BETWEEN_PARTS = 1,         ///< each part touches the others
    ALSO_WITH_THEMSELVES = 2,  ///< and itself
    BETWEEN_SIDES_OF_A_CUT = 3 ///< as they do too where nothing else is set
  };

  /// What the parts are.
  enum Divider
  {
    PIECES = 0,    ///< the connected pieces
    PART_ARRAY = 1 ///< cells with the same number in an array
  };

  ///@{
  /// A Chooser.
  vtkSetMacro(FixedBy, int);
  vtkGetMacro(FixedBy, int);
  vtkSetMacro(TouchableBy, int);
  vtkGetMacro(TouchableBy, int);
  ///@}
  ///@{
  /// A Holder, and the direction, of any length but 0, and the stiffness, N/m³, that it needs.
  vtkSetMacro(Support, int);
  vtkGetMacro(Support, int);
  vtkSetVector3Macro(HeldDirection, double);
  vtkGetVector3Macro(HeldDirection, double);
  vtkSetMacro(SupportStiffness, double);
  vtkGetMacro(SupportStiffness, double);
  ///@}
  ///@{
  /// A Loader, a Chooser of whole faces, and the pressure or the traction, Pa.
  vtkSetMacro(Load, int);
  vtkGetMacro(Load, int);
  vtkSetMacro(LoadBy, int);
  vtkGetMacro(LoadBy, int);
  vtkSetMacro(AppliedPressure, double);
  vtkGetMacro(AppliedPressure, double);
  vtkSetVector3Macro(AppliedTraction, double);
  vtkGetVector3Macro(AppliedTraction, double);
  ///@}
  ///@{
  /// A Toucher, a Divider and the name of a cell array with one component; the thickness of
  /// contact, m, and its stiffness, Pa: 0 is a usual one.
  vtkSetMacro(Contact, int);
  vtkGetMacro(Contact, int);
  vtkSetMacro(PartsBy, int);
  vtkGetMacro(PartsBy, int);
  vtkSetStdStringFromCharMacro(PartArray);
  vtkGetCharFromStdStringMacro(PartArray);
  vtkSetMacro(ContactThickness, double);
  vtkGetMacro(ContactThickness, double);
  vtkSetMacro(ContactStiffness, double);
  vtkGetMacro(ContactStiffness, double);
  ///@}
  ///@{
  /// The points where the function is not positive: those within a box, sphere or cylinder, those
  /// on the side of a plane that its normal points away from.
  void SetFixedRegion(vtkImplicitFunction* region);
  void SetTouchableRegion(vtkImplicitFunction* region);
  void SetLoadRegion(vtkImplicitFunction* region);
  ///@}
  ///@{
  /// Name of a point array with one component; "None" or empty for none.
  vtkSetStdStringFromCharMacro(FixedArray);
  vtkGetCharFromStdStringMacro(FixedArray);
  vtkSetStdStringFromCharMacro(TouchableArray);
  vtkGetCharFromStdStringMacro(TouchableArray);
  vtkSetStdStringFromCharMacro(LoadArray);
  vtkGetCharFromStdStringMacro(LoadArray);
  ///@}
  ///@{
  /// Whether points of different pieces of the body that coincide become one.
  vtkSetMacro(Merge, bool);
  vtkGetMacro(Merge, bool);
  vtkBooleanMacro(Merge, bool);
  ///@}
  ///@{
  /// A vtkSelection of points or cells of the body.
  void SetFixedSelectionConnection(vtkAlgorithmOutput* selection);
  void SetTouchableSelectionConnection(vtkAlgorithmOutput* selection);
  void SetLoadSelectionConnection(vtkAlgorithmOutput* selection);
  ///@}

  vtkMTimeType GetMTime() override;

protected:
  vtkPalpateSetBoundary();
  ~vtkPalpateSetBoundary() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateSetBoundary(const vtkPalpateSetBoundary&) = delete;
  void operator=(const vtkPalpateSetBoundary&) = delete;

  void SetRegion(vtkSmartPointer<vtkImplicitFunction>& region, vtkImplicitFunction* to);
  /// The mesh, with the supports and loads of the input that are kept.
  palpate::Scene SceneBefore(vtkUnstructuredGrid* body) const;
  /// Holds the chosen points of a scene, which already has its mesh and the arrays of its grid.
  void Hold(const std::vector<char>& chosen, palpate::Scene& scene) const;
  /// Lets the parts touch each other.
  void Touch(vtkUnstructuredGrid* body, palpate::Scene& scene) const;
  /// Loads the faces of the chosen points. @returns The area that bears such a load, m².
  double LoadFaces(const std::vector<char>& chosen, palpate::Scene& scene) const;

  int Support = FIXED;
  double HeldDirection[3] = { 0, 0, 1 };
  double SupportStiffness = 1e5;
  int Load = NO_LOAD;
  int LoadBy = REGION;
  double AppliedPressure = 1000;
  double AppliedTraction[3] = { 0, 0, -100 };
  vtkSmartPointer<vtkImplicitFunction> LoadRegion;
  std::string LoadArray = "None";
  int FixedBy = REGION;
  int TouchableBy = SURFACE;
  vtkSmartPointer<vtkImplicitFunction> FixedRegion;
  vtkSmartPointer<vtkImplicitFunction> TouchableRegion;
  std::string FixedArray = "None";
  std::string TouchableArray = "None";
  bool Merge = false;
  int Contact = NO_CONTACT;
  int PartsBy = PIECES;
  std::string PartArray = "None";
  double ContactThickness = 0;
  double ContactStiffness = 0;
};
