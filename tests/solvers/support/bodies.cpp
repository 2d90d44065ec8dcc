// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/support/bodies.h"
#include "interaction/bonded_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::test {
namespace {

Vec3 middle_of(const TetMesh& mesh, Index cell) {
  Vec3 sum = Vec3::Zero();
  for (int a = 0; a < 4; ++a) sum += mesh.points[mesh.cell(cell)[a]];
  return sum / 4;
}

std::array<Vec3, 4> corners_of(const TetMesh& mesh, Index cell) {
  const Index* nodes = mesh.cell(cell);
  return {mesh.points[nodes[0]], mesh.points[nodes[1]], mesh.points[nodes[2]],
          mesh.points[nodes[3]]};
}

/// Normal of the face opposite to corner a, away from it, as long as twice the face's area.
Vec3 face_normal(const std::array<Vec3, 4>& corner, int a) {
  const Vec3& origin = corner[(a + 1) % 4];
  const Vec3 normal = (corner[(a + 2) % 4] - origin).cross(corner[(a + 3) % 4] - origin);
  return normal.dot(corner[a] - origin) > 0 ? Vec3(-normal) : normal;
}

/// The brick's corner i has the bits x, y, z of i. A tetrahedron each for the ways from corner 0 to
/// corner 7 along the edges (Kuhn).
constexpr int kKuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                             {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

}  // namespace

Index nearest_point(const TetMesh& mesh, const Vec3& place) {
  const std::vector<char> in_use = points_in_use(mesh);
  Index best = -1;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (in_use[p] == 0) continue;
    if (best < 0 || (mesh.points[p] - place).norm() < (mesh.points[best] - place).norm()) best = p;
  }
  return best;
}

std::vector<Index> points_where(const TetMesh& mesh,
                                const std::function<bool(const Vec3&)>& holds) {
  const std::vector<char> in_use = points_in_use(mesh);
  std::vector<Index> points;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (in_use[p] != 0 && holds(mesh.points[p])) points.push_back(p);
  }
  return points;
}

InteractionList bond_as_one(const std::vector<Index>& points) {
  InteractionList tools;
  tools.add(BondedPatch(points));
  return tools;
}

void put_inside(Scene& scene, const Material& other,
                const std::function<bool(const Vec3&)>& inside) {
  scene.organ.materials.push_back(other);
  scene.body.material_of_cell.clear();
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    scene.body.material_of_cell.push_back(inside(middle_of(scene.body.mesh, c)) ? 1 : 0);
  }
}

TetMesh make_graded_box(ElementOrder order, const std::array<std::vector<double>, 3>& planes,
                        const Vec3& size) {
  std::array<int, 3> cells{};
  for (int i = 0; i < 3; ++i) cells[i] = static_cast<int>(planes[i].size()) - 1;
  TetMesh mesh = make_box(order, cells, Vec3(cells[0], cells[1], cells[2]));
  warp_straight(mesh, [&](const Vec3& p) {
    Vec3 place;
    for (int i = 0; i < 3; ++i) {
      place[i] = size[i] * planes[i][static_cast<std::size_t>(std::lround(2 * p[i]) / 2)];
    }
    return place;
  });
  return mesh;
}

double least_dihedral_angle(const TetMesh& mesh) {
  double largest_cosine = -1;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const auto corner = corners_of(mesh, c);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) {
        largest_cosine =
            std::max(largest_cosine,
                     -face_normal(corner, a).normalized().dot(face_normal(corner, b).normalized()));
      }
    }
  }
  return std::acos(std::min(largest_cosine, 1.0)) * 180 / M_PI;
}

double largest_aspect_ratio(const TetMesh& mesh) {
  double largest = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const auto corner = corners_of(mesh, c);
    double longest = 0;
    double least_height = INFINITY;
    for (const auto& edge : kTetEdges) {
      longest = std::max(longest, (corner[edge[0]] - corner[edge[1]]).norm());
    }
    for (int a = 0; a < 4; ++a) {
      const Vec3 normal = face_normal(corner, a).normalized();
      least_height = std::min(least_height, normal.dot(corner[(a + 1) % 4] - corner[a]));
    }
    largest = std::max(largest, longest / least_height);
  }
  return largest;
}

TetMesh make_sliver_box(ElementOrder order, double degrees, double size) {
  const TetMesh regular = make_box(ElementOrder::linear, {2, 2, 2}, Vec3::Constant(size));
  const Index middle = nearest_point(regular, Vec3::Constant(size / 2));
  // The face opposite to it in the first of its cells.
  Vec3 target = Vec3::Zero();
  for (Index c = 0; c < regular.num_cells(); ++c) {
    const Index* cell = regular.cell(c);
    if (std::find(cell, cell + 4, middle) == cell + 4) continue;
    for (int a = 0; a < 4; ++a) {
      if (cell[a] != middle) target += regular.points[cell[a]] / 3;
    }
    break;
  }
  TetMesh mesh = regular;
  const auto angle_at = [&](double share) {
    mesh.points[middle] = target + share * (regular.points[middle] - target);
    return least_dihedral_angle(mesh);
  };
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double share = (low + high) / 2;
    (angle_at(share) < degrees ? low : high) = share;
  }
  (void)angle_at(high);
  return order == ElementOrder::linear ? mesh : with_midside_nodes(mesh);
}

void append(TetMesh& mesh, const TetMesh& other, const Vec3& shift) {
  const Index num_points = mesh.num_points();
  for (const Vec3& point : other.points) mesh.points.push_back(point + shift);
  for (Index p : other.cells) mesh.cells.push_back(p + num_points);
}

void add_copy(TetMesh& mesh, const Vec3& shift) { append(mesh, TetMesh(mesh), shift); }

Roof make_roof(const RoofOptions& options) {
  // In the parameters: angle in units of the half angle and length in units of half of it, both
  // −1 … 1, height 0 … 1 through the thickness. One brick through the thickness: its midside nodes
  // are the middle of it.
  const int m = options.cells_arc;
  const int n = options.cells_length;
  TetMesh flat;
  const auto point = [&](int i, int j, int k) {
    return static_cast<Index>(((k * (2 * n + 1)) + j + n) * (2 * m + 1) + i + m);
  };
  for (int k = 0; k <= 1; ++k) {
    for (int j = -n; j <= n; ++j) {
      for (int i = -m; i <= m; ++i) {
        flat.points.emplace_back(static_cast<double>(i) / m, static_cast<double>(j) / n, k);
      }
    }
  }
  // The bricks of a quarter, and their mirror images: a diagonal starts at the corner that is
  // nearest to the centre.
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < m; ++i) {
      for (int mirror = 0; mirror < 4; ++mirror) {
        const int sign_i = (mirror & 1) != 0 ? -1 : 1;
        const int sign_j = (mirror & 2) != 0 ? -1 : 1;
        for (const auto& tetrahedron : kKuhn) {
          Index corner[4];
          for (int a = 0; a < 4; ++a) {
            const int bits = tetrahedron[a];
            corner[a] =
                point(sign_i * (i + (bits & 1)), sign_j * (j + ((bits >> 1) & 1)), (bits >> 2) & 1);
          }
          if (sign_i * sign_j < 0) std::swap(corner[1], corner[2]);
          flat.cells.insert(flat.cells.end(), corner, corner + 4);
        }
      }
    }
  }
  Roof roof;
  roof.mesh = with_midside_nodes(flat);
  const TetMesh parameters = roof.mesh;
  warp_curved(roof.mesh, [&](const Vec3& p) -> Vec3 {
    const double angle = options.half_angle * p.x();
    const double radius = options.radius + options.thickness * (p.z() - 0.5);
    return {radius * std::sin(angle), options.length / 2 * p.y(), radius * std::cos(angle)};
  });
  for (const Vec3& p : parameters.points) {
    roof.fixed.push_back(std::abs(p.x()) == 1 && p.z() == 0.5 ? 1 : 0);
  }
  roof.centre =
      bond_as_one(points_where(parameters, [](const Vec3& p) { return p.x() == 0 && p.y() == 0; }));
  return roof;
}

}  // namespace palpate::test
