// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "assembly/loaded_faces.h"
#include "mesh/cell_faces.h"

namespace palpate {
namespace {

/// An edge is divided at most this often, however coarse a face is.
constexpr int kMostDivisions = 8;
constexpr int kPointsOfRule = 6;
static_assert(kPointsOfRule <= kPacketSize);

/// The shapes of one triangle of a divided face. The last point fills up the packet.
ShapePacket shapes_at(const FacePoint* points, int nodes_per_face) {
  ShapePacket shapes{};
  for (int i = 0; i < kPacketSize; ++i) {
    const FacePoint& point = points[std::min(i, kPointsOfRule - 1)];
    for (int a = 0; a < nodes_per_face; ++a) {
      const double values[3] = {point.values[a], point.slopes(a, 0), point.slopes(a, 1)};
      for (int k = 0; k < 3; ++k) {
        shapes.of_nodes[a][k][i] = values[k];
        shapes.at_points[i][k][a] = values[k];
      }
    }
  }
  return shapes;
}

/// @param corners Of a face of the cell.
bool is_open_face(const Body& body, Index cell, const Index* corners) {
  if (body.cut.faces.empty()) return false;
  const int opposite = corner_opposite(body.mesh.cell(cell), corners);
  return is_open(body.cut.faces[cell][opposite], body.cut.stage);
}

}  // namespace

ContactPoints::ContactPoints(const Body& body, const std::vector<double>& spacings,
                             std::vector<double> reaches)
    : nodes_per_face_(palpate::nodes_per_face(body.mesh.order)),
      rest_(body.mesh.points),
      reaches_(std::move(reaches)) {
  std::vector<Index> cells;
  nodes_ = boundary_faces(body.mesh, &cells);
  std::map<int, Index> first_shape;
  std::map<int, std::vector<FacePoint>> rules;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const Index* face = &nodes_[f * static_cast<std::size_t>(nodes_per_face_)];
    const Eigen::Matrix3Xd places = places_of_face(body.mesh, face);
    const double area =
        0.5 * (places.col(1) - places.col(0)).cross(places.col(2) - places.col(0)).norm();
    const double wanted = std::round(std::sqrt(area / kPointsOfRule) / spacings[f]);
    const int divisions = static_cast<int>(std::clamp(wanted, 1.0, double{kMostDivisions}));
    std::vector<FacePoint>& rule = rules[divisions];
    if (rule.empty()) {
      rule = divided_quadrature(body.mesh.order, divisions);
      first_shape[divisions] = static_cast<Index>(shapes_.size());
      for (std::size_t p = 0; p < rule.size(); p += kPointsOfRule) {
        shapes_.push_back(shapes_at(&rule[p], nodes_per_face_));
      }
    }
    first_shape_.push_back(first_shape[divisions]);
    part_.push_back(body.part_of(cells[f]));
    is_lip_.push_back(is_open_face(body, cells[f], face) ? 1 : 0);
    is_fixed_.push_back(
        std::all_of(face, face + nodes_per_face_, [&](Index p) { return body.fixed[p] != 0; }) ? 1
                                                                                               : 0);
    for (std::size_t p = 0; p < rule.size(); p += kPointsOfRule) {
      for (int i = 0; i < kPointsOfRule; ++i) areas_.push_back(area_at(rule[p + i], places));
      areas_.resize(areas_.size() + kPacketSize - kPointsOfRule, 0.0);
      face_of_.push_back(static_cast<Index>(f));
    }
    first_packet_.push_back(static_cast<Index>(face_of_.size()));
  }
}

struct ContactPoints::FaceList {
  std::vector<Index> nodes;
  std::vector<std::int32_t> first_packet;
  std::vector<const ShapePacket*> shapes;
  std::vector<const double*> areas;
  std::vector<double> reaches;

  [[nodiscard]] ContactFacesView view(int nodes_per_face) const {
    return {static_cast<std::int32_t>(shapes.size()),
            nodes_per_face,
            nodes.data(),
            first_packet.data(),
            shapes.data(),
            areas.data(),
            reaches.data()};
  }
};

ContactPoints::FaceList ContactPoints::list(const std::vector<Index>& faces) const {
  FaceList result;
  result.first_packet.push_back(0);
  for (const Index f : faces) {
    const Index* of_face = nodes(f);
    result.nodes.insert(result.nodes.end(), of_face, of_face + nodes_per_face_);
    result.first_packet.push_back(result.first_packet.back() + first_packet(f + 1) -
                                  first_packet(f));
    result.shapes.push_back(shapes(f));
    result.areas.push_back(&areas_[first_point(f)]);
    result.reaches.push_back(reaches_[f]);
  }
  return result;
}

void ContactPoints::take_features(const std::vector<Index>& faces, const NodalVector& state,
                                  std::vector<PointPacket>& points) const {
  const FaceList list = this->list(faces);
  const NodalVector places =
      Eigen::Map<const NodalVector>(rest_.front().data(),
                                    3 * static_cast<Eigen::Index>(rest_.size())) +
      state.head(3 * static_cast<Eigen::Index>(rest_.size()));
  points.resize(static_cast<std::size_t>(list.first_packet.back()));
  best_contact_kernels().features(list.view(nodes_per_face_), places.data(), points.data());
}

void ContactPoints::add_to_nodes(const std::vector<Index>& faces,
                                 const std::vector<PointPacket>& points,
                                 const std::vector<double>& gradient, NodalVector& of_nodes) const {
  const FaceList list = this->list(faces);
  best_contact_kernels().to_nodes(list.view(nodes_per_face_), points.data(), gradient.data(),
                                  of_nodes.data());
}

Vec3 ContactPoints::corner_normal(Index face, int corner, const NodalVector& state) const {
  // The edges leave the corner towards the next two; a midside node follows the corners, in the
  // order of the edges 01, 12, 20.
  const Index* all = nodes(face);
  const int next = (corner + 1) % 3;
  const int last = (corner + 2) % 3;
  const Vec3 here = node_place(all[corner], state);
  Vec3 tangent_1 = node_place(all[next], state) - here;
  Vec3 tangent_2 = node_place(all[last], state) - here;
  if (nodes_per_face_ == kMostFaceNodes) {
    tangent_1 = 4 * (node_place(all[3 + corner], state) - here) - tangent_1;
    tangent_2 = 4 * (node_place(all[3 + last], state) - here) - tangent_2;
  }
  return tangent_1.cross(tangent_2).normalized();
}

}  // namespace palpate
