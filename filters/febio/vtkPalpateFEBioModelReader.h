// SPDX-License-Identifier: BSD-3-Clause
// Reads vtkPalpateFEBioModel from the tree of a file.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "assembly/scene.h"
#include "vtkPalpateFEBioModel.h"
#include "vtkPalpateFEBioText.h"
#include "vtkPalpateFEBioUnits.h"
#include "vtkPalpateXMLTree.h"

namespace vtkPalpateFEBio
{
class ModelReader
{
public:
  ModelReader(const Tree& root, int units);

  vtkPalpateFEBioModel Read();

private:
  void CheckVersion();

  void ChooseUnits(int units);

  void CheckSection(const Tree& section);

  void CheckConstraints(const Tree& section) const;

  void CheckStep(const Tree& step);

  void LeaveOut(const Tree& what);

  /// True where the condition moves points.
  bool LeaveOutPrescribed(const Tree& condition);

  void ReadNodes();

  palpate::Index IndexOf(Id node, const Tree& where) const;

  static palpate::ElementOrder OrderOf(const Tree& elements);

  void ReadElements();

  /// @param parts Those of Model.Regions.
  void ReadMaterials(const std::vector<const Tree*>& parts);

  /// The nodes of a set, of a surface (@surface:), an edge (@edge:) or elements (@elem_set:).
  std::vector<Id> NodesOf(const std::string& reference, const Tree& where) const;

  /// 1, 2 and 4 for x, y and z, of those that a condition holds.
  static int AxesOf(const Tree& condition);

  void ReadBoundary();

  /// Holds a point along one more direction, of the length 1; along three it is fixed.
  void Hold(palpate::Index point, const palpate::Vec3& direction);

  using Face = std::vector<palpate::Index>;

  std::vector<Face> FacesOf(const std::string& name, const Tree& where) const;

  /// Twice the area of its triangle is its length.
  palpate::Vec3 NormalOf(const Face& face) const;

  void ReadSymmetryPlane(const Tree& constraint);

  void ReadLoads();

  using Corners = std::array<palpate::Index, 3>;

  /// In the order of their numbers.
  static Corners CornersOf(const Face& face);

  /// The surface of the body.
  struct Boundary
  {
    std::vector<Face> Faces;
    /// The place of each in Faces.
    std::map<Corners, std::size_t> Of;
    /// The places of those of which a point is a corner.
    std::vector<std::vector<std::size_t>> At;
  };

  /// Made when a load is first read.
  const Boundary& Surface();

  /// 1 where all faces look out of the body, -1 where all look into it, else 0.
  int SideOf(const std::vector<Face>& faces);

  /// Gives the points of faces of the surface a value.
  /// @param carries Whether an array loads a face with these corners.
  /// @returns False, and nothing is changed, where the array would not load these and those before.
  template <class Value, class Carries>
  bool Load(const std::vector<Face>& faces, const Value& value, const Value& none,
    std::vector<Value>& array, Carries&& carries);

  /// A constant pressure or traction on faces of the surface, that may be said point by point.
  bool ReadLoad(const Tree& load);

  void ReadTouchable();

  static constexpr palpate::Index NoMaterial = -1;
  static constexpr const char* SymmetryPlane = "symmetry plane";

  const Tree& Root;
  const Tree* Mesh = nullptr;
  const vtkPalpateFEBioUnits* Units = nullptr;
  /// In the order of the points, and back.
  KnownIds Nodes{ {}, "node" };
  std::unordered_map<Id, palpate::Index> IndexOfNode;
  KnownIds Elements{ {}, "element" };
  /// Of the mesh.
  ChildIndex Sets{ nullptr };
  std::optional<Boundary> Outside;
  vtkPalpateFEBioModel Model;
};
}
