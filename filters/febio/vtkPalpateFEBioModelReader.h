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

  /// Leaves a condition out, with a warning, if it moves points. @returns Whether it does.
  bool LeaveOutPrescribed(const Tree& condition);

  void ReadNodes();

  palpate::Index IndexOf(Id node, const Tree& where) const;

  static palpate::ElementOrder OrderOf(const Tree& elements);

  void ReadElements();

  /// @param parts The parts of Model.Regions.
  void ReadMaterials(const std::vector<const Tree*>& parts);

  /// The nodes of a set, of a surface (@surface:), an edge (@edge:) or elements (@elem_set:).
  std::vector<Id> NodesOf(const std::string& reference, const Tree& where) const;

  /// The axes that a condition holds: the sum of 1, 2 and 4 for x, y and z.
  static int AxesOf(const Tree& condition);

  void ReadBoundary();

  /// Holds a point along one more direction, of length 1. A point that is held along three
  /// directions is fixed.
  void Hold(palpate::Index point, const palpate::Vec3& direction);

  using Face = std::vector<palpate::Index>;

  std::vector<Face> FacesOf(const std::string& name, const Tree& where) const;

  /// The normal of a face. Its length is twice the area of the face's triangle.
  palpate::Vec3 NormalOf(const Face& face) const;

  void ReadSymmetryPlane(const Tree& constraint);

  void ReadLoads();

  using Corners = std::array<palpate::Index, 3>;

  /// The corners of a face, in ascending order.
  static Corners CornersOf(const Face& face);

  /// The surface of the body.
  struct Boundary
  {
    std::vector<Face> Faces;
    /// The index of each face in Faces, by its corners.
    std::map<Corners, std::size_t> Of;
    /// For each point, the indices of the faces of which it is a corner.
    std::vector<std::vector<std::size_t>> At;
  };

  /// The surface of the body. It is made when a load is first read.
  const Boundary& Surface();

  /// 1 where all faces look out of the body, -1 where all look into it, else 0.
  int SideOf(const std::vector<Face>& faces);

  /// Gives the points of faces of the surface a value.
  /// @param carries Whether an array loads a face with these corners.
  /// @returns False, without any change, if the array would not load exactly these faces and the
  ///   earlier ones.
  template <class Value, class Carries>
  bool Load(const std::vector<Face>& faces, const Value& value, const Value& none,
    std::vector<Value>& array, Carries&& carries);

  /// Reads a constant pressure or traction on faces of the surface, if values at the points can
  /// describe it.
  bool ReadLoad(const Tree& load);

  void ReadTouchable();

  static constexpr palpate::Index NoMaterial = -1;
  static constexpr const char* SymmetryPlane = "symmetry plane";

  const Tree& Root;
  const Tree* Mesh = nullptr;
  const vtkPalpateFEBioUnits* Units = nullptr;
  /// The ids of the nodes in the order of the points, and the point of each id.
  KnownIds Nodes{ {}, "node" };
  std::unordered_map<Id, palpate::Index> IndexOfNode;
  KnownIds Elements{ {}, "element" };
  /// The sets of the mesh, by name.
  ChildIndex Sets{ nullptr };
  std::optional<Boundary> Outside;
  vtkPalpateFEBioModel Model;
};
}
