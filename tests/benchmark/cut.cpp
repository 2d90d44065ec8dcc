// SPDX-License-Identifier: BSD-3-Clause
// Sheets of cuts in the mesh of a real body.
//
//   palpate_benchmark_cut space.palpate [--planes 500] [--curved 200] [--severing 100] [--seed 1]
//     [--edge 0]
//
// Each sheet begins outside the body and ends at a random place within it, across a random
// direction. Prints how many meshes are sound, what the others are refused for, the least angles
// and how long it takes: a row of the table of README.md. Severing sheets go right through the
// body, and are to be refused for that.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "arguments.h"
#include "base/error.h"
#include "cutting/sheet_mesh.h"
#include "cutting/straight_cells.h"
#include "solvers/support/random.h"
#include "storage/state_space_file.h"
#include "table.h"

namespace palpate {
namespace {

using benchmarks::seconds;

/// A sheet that ends at a place, across a direction, and is bent.
Sheet make_sheet(const Vec3& end, const Vec3& normal, const Vec3& along, const Vec3& bend,
                 double size, double step) {
  const Vec3 across = normal.cross(along);
  const int n = std::max(1, static_cast<int>(std::ceil(size / step)));
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<double> front;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= 2 * n; ++j) {
      const double x = -size + size * i / n;
      const double y = size * (j - n) / n;
      const double z = bend[0] * x * x + bend[1] * x * y + bend[2] * y * y;
      points.push_back(end + x * along + y * across + z * normal);
      front.push_back(x);
      if (i == n || j == 2 * n) continue;
      const Index a = i * (2 * n + 1) + j;
      const Index b = a + 2 * n + 1;
      triangles.push_back({a, b, a + 1});
      triangles.push_back({a + 1, b, b + 1});
    }
  }
  return Sheet(std::move(points), std::move(triangles), std::move(front));
}

Vec3 middle_of(const TetMesh& mesh, Index cell) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 4; ++k) sum += 0.25 * mesh.points[mesh.cell(cell)[k]];
  return sum;
}

double size_of(const TetMesh& mesh) {
  BoxTree::Box box;
  for (const Vec3& x : mesh.points) box.extend(x);
  return 1.2 * box.diagonal().norm();
}

void run_severing(const TetMesh& mesh, const std::vector<Index>& tissues, int sheets, double edge,
                  unsigned seed) {
  test::Random random(seed);
  const double size = size_of(mesh);
  int severed = 0;
  std::map<std::string, int> otherwise;
  for (int i = 0; i < sheets; ++i) {
    const Vec3 place = middle_of(mesh, static_cast<Index>(random.uniform(0, mesh.num_cells())));
    const Vec3 normal = Vec3(random.vector(3, 1)).normalized();
    const Vec3 along = normal.cross(Vec3(random.vector(3, 1))).normalized();
    const Sheet sheet =
        make_sheet(place + size * along, normal, along, Vec3::Zero(), 2 * size, 2 * size);
    SheetOptions options;
    options.edge = edge;
    try {
      (void)put_sheet(mesh, tissues, sheet, options);
      ++otherwise["a mesh was made"];
    } catch (const InputError& error) {
      const std::string text = error.what();
      text.find("severs") != std::string::npos ? ++severed : ++otherwise[text.substr(0, 60)];
    }
  }
  std::printf("%d of %d severing sheets are refused for that.\n", severed, sheets);
  for (const auto& [text, count] : otherwise) std::printf("  %d: %s\n", count, text.c_str());
}

void run(const char* what, const TetMesh& mesh, const std::vector<Index>& tissues, int sheets,
         bool is_curved, double edge, unsigned seed) {
  test::Random random(seed);
  const double size = size_of(mesh);
  int tried = 0, sound = 0, severed = 0;
  std::map<std::string, int> refused;
  std::vector<double> angles, cells;
  double time = 0, longest = 0;
  while (tried < sheets) {
    const Vec3 end = middle_of(mesh, static_cast<Index>(random.uniform(0, mesh.num_cells())));
    const Vec3 normal = Vec3(random.vector(3, 1)).normalized();
    const Vec3 along = normal.cross(Vec3(random.vector(3, 1))).normalized();
    // Radii of curvature from a third of the body's size.
    const Vec3 bend = is_curved ? Vec3(random.vector(3, 1.5 / size)) : Vec3::Zero();
    const Sheet sheet = make_sheet(end, normal, along, bend, size, is_curved ? 0.02 * size : size);
    SheetOptions options;
    options.edge = edge;
    std::string problem;
    SheetMesh cut;
    const double taken = seconds([&] {
      try {
        cut = put_sheet(mesh, tissues, sheet, options);
      } catch (const InputError& error) {
        problem = error.what();
      }
    });
    if (problem.find("severs") != std::string::npos) {
      ++severed;
      continue;
    }
    ++tried;
    time += taken;
    longest = std::max(longest, taken);
    if (problem.empty()) {
      ++sound;
      angles.push_back(cut.least_angle);
      cells.push_back(cut.mesh.num_cells());
    } else {
      ++refused[problem.substr(0, 60)];
    }
  }
  std::sort(angles.begin(), angles.end());
  std::sort(cells.begin(), cells.end());
  std::printf("| %s | %d | %d | %.1f | %d | %.1f, %.1f | %.0f of %d | %.2f, %.1f |\n", what, tried,
              sound, 100.0 * sound / tried, severed, angles.empty() ? 0 : angles.front(),
              angles.empty() ? 0 : angles[angles.size() / 2],
              cells.empty() ? 0 : cells[cells.size() / 2], mesh.num_cells(), time / tried, longest);
  for (const auto& [text, count] : refused) std::printf("  %d: %s\n", count, text.c_str());
  std::fflush(stdout);
}

void run_all(const Arguments& arguments) {
  const Body body = StateSpaceFile::open_read_only(arguments.scene).read_scene().body;
  const TetMesh mesh = straight_cells(body.mesh);
  const std::vector<Index>& tissues = body.material_of_cell;
  std::printf("least angle of the mesh: %.1f\n", least_dihedral_angle(mesh));
  std::puts(
      "| sheets | tried | sound | % | severing, refused | least angle: least, median | cells | s: "
      "mean, longest |\n|---|---|---|---|---|---|---|---|");
  const auto seed = static_cast<unsigned>(arguments["seed"]);
  run("planes", mesh, tissues, static_cast<int>(arguments["planes"]), false, arguments["edge"],
      seed);
  run("curved", mesh, tissues, static_cast<int>(arguments["curved"]), true, arguments["edge"],
      seed + 1);
  run_severing(mesh, tissues, static_cast<int>(arguments["severing"]), arguments["edge"], seed + 2);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    palpate::run_all(palpate::Arguments(
        argc, argv,
        {{"planes", 500}, {"curved", 200}, {"severing", 100}, {"seed", 1}, {"edge", 0}}));
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  return 0;
}
