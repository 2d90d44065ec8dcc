// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/stability_matrix/case.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/laws.h"
#include "solvers/support/orders.h"

namespace palpate::test {
namespace {

constexpr Flags kSomehow = flags::inverted | flags::unstable | flags::near_fold;
constexpr Outcome kStops[] = {Outcome::not_converged, Outcome::tangent_not_factorised};

constexpr double kYoungsModulus = 3000;
constexpr double kPoissonsRatio = 0.35;
/// Edge of the cubes and length of the blocks, m.
constexpr double kSize = 0.1;

constexpr Law kAllLaws[] = {Law::linear,
                            Law::st_venant_kirchhoff,
                            Law::neo_hookean,
                            Law::mooney_rivlin,
                            Law::mooney_rivlin_polynomial,
                            Law::fung,
                            Law::neo_hookean_incompressible,
                            Law::mooney_rivlin_incompressible,
                            Law::ogden};

std::string order_name(ElementOrder order) {
  return order == ElementOrder::linear ? "Tet4" : "Tet10";
}

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Material tissue(Law law, double poissons_ratio = kPoissonsRatio) {
  return make_material(law, kYoungsModulus, poissons_ratio);
}

std::vector<char> fixed_where(const TetMesh& mesh, const std::function<bool(const Vec3&)>& holds) {
  std::vector<char> fixed;
  for (const Vec3& p : mesh.points) fixed.push_back(holds(p) ? 1 : 0);
  return fixed;
}

bool at_left(const Vec3& p) { return p.x() < 1e-9; }

Problem hold_point(Scene scene, Index point, const Vec3& t) {
  return {std::move(scene), bond_nodes({point}), {t}};
}

/// Calls f for each kind of cell and each law.
template <class F>
void for_each_body(F&& f) {
  for (ElementOrder order : kOrders) {
    for (Law law : kAllLaws) f(order, law, order_name(order) + ", " + to_string(law));
  }
}

// Stiffness contrast -------------------------------------------------------------------------

void add_contrasts(std::vector<Case>& cases) {
  // Everything is convex enough at these displacements: one stable equilibrium.
  for (double contrast : {1.0, 1e3, 1e6, 1e9}) {
    const std::string ratio = number(contrast);
    Expected ends = converges();
    // There rounding is a share of 1e9 · 1e-16 of the displacement of the soft part, and more.
    if (contrast == 1e9) ends.may = flags::inaccurate;
    Expected shell = converges_or_stops();
    shell.may |= ends.may;
    for_each_body([&](ElementOrder order, Law law, const std::string& body) {
      cases.push_back(
          {"Stiff inclusion, " + ratio, body, ends, [=] {
             Scene scene =
                 make_scene(make_box(order, {3, 3, 3}, Vec3::Constant(kSize)), tissue(law), {});
             scene.body.fixed = fixed_where(scene.body.mesh, at_left);
             const auto inside = [](const Vec3& p) {
               return (p - Vec3::Constant(kSize / 2)).lpNorm<Eigen::Infinity>() < kSize / 6;
             };
             put_inside(scene, scaled(tissue(law), contrast), inside);
             const Index corner = nearest_point(scene.body.mesh, Vec3::Constant(kSize));
             return hold_point(std::move(scene), corner, kSize * Vec3(0.08, 0.04, -0.06));
           }});
      cases.push_back(
          {"Stiff layer, " + ratio, body, ends, [=] {
             Scene scene =
                 make_scene(make_box(order, {4, 2, 2}, Vec3::Constant(kSize)), tissue(law), {});
             scene.body.fixed = fixed_where(scene.body.mesh, at_left);
             put_inside(scene, scaled(tissue(law), contrast),
                        [](const Vec3& p) { return p.x() > kSize / 4 && p.x() < kSize / 2; });
             const Index corner = nearest_point(scene.body.mesh, Vec3::Constant(kSize));
             return hold_point(std::move(scene), corner, kSize * Vec3(0.08, 0.04, -0.06));
           }});
      cases.push_back(
          {"Thin stiff shell around a soft core, " + ratio, body,
           // Its own thickness, contrast and incompressibility together leave no digits.
           contrast == 1e9 && is_incompressible(law) ? shell : ends, [=] {
             const std::vector<double> planes = {0, 0.02, 0.5, 0.98, 1};
             Scene scene =
                 make_scene(make_graded_box(order, {planes, {0, 0.02, 0.98, 1}, {0, 0.02, 0.98, 1}},
                                            Vec3::Constant(kSize)),
                            tissue(law), {});
             scene.body.fixed = fixed_where(scene.body.mesh, at_left);
             put_inside(scene, scaled(tissue(law), contrast), [](const Vec3& p) {
               return (p - Vec3::Constant(kSize / 2)).lpNorm<Eigen::Infinity>() > 0.48 * kSize;
             });
             const Index edge = nearest_point(scene.body.mesh, kSize * Vec3(0.5, 1, 1));
             return hold_point(std::move(scene), edge, kSize * Vec3(0.01, -0.004, 0.006));
           }});
    });
  }
}

// Poisson's ratio ----------------------------------------------------------------------------

void add_poissons_ratios(std::vector<Case>& cases) {
  for (double ratio : {0.0, 0.3, 0.45, 0.49, 0.499, 0.4999, 0.5}) {
    for_each_body([&](ElementOrder order, Law law, const std::string& body) {
      if (is_incompressible(law) != (ratio == 0.5)) return;
      cases.push_back(
          {"Poisson's ratio " + number(ratio), body, converges(), [=] {
             Block block = make_block(law, {order, {3, 2, 2}, kSize, kYoungsModulus, ratio});
             return hold_point(std::move(block.scene), block.corner,
                               kSize * Vec3(0.12, 0.06, -0.1));
           }});
    });
  }
}

// Slivers ------------------------------------------------------------------------------------

void add_slivers(std::vector<Case>& cases) {
  const auto cube = [](TetMesh mesh, Law law) {
    const std::vector<char> fixed = fixed_where(mesh, at_left);
    const Index corner = nearest_point(mesh, Vec3::Constant(kSize));
    return hold_point(make_scene(std::move(mesh), tissue(law), fixed), corner,
                      kSize * Vec3(0.06, 0.03, -0.05));
  };
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    for (double degrees : {10.0, 1.0, 0.1}) {
      cases.push_back({"Dihedral angle of " + number(degrees) + "°", body, converges(),
                       [=] { return cube(make_sliver_box(order, degrees, kSize), law); }});
    }
    for (double aspect : {1e2, 1e4}) {
      cases.push_back(
          {"Aspect ratio of " + number(aspect), body, converges(), [=] {
             const double width = 1 / aspect;
             return cube(
                 make_graded_box(
                     order, {{{0, 0.5 - width / 2, 0.5 + width / 2, 1}, {0, 0.5, 1}, {0, 0.5, 1}}},
                     Vec3::Constant(kSize)),
                 law);
           }});
    }
  });
}

// Large displacements ------------------------------------------------------------------------

/// A block of which the far end is one bonded patch.
Problem patch_problem(ElementOrder order, Law law, const Vec3& t, int steps) {
  Block block = make_block(law, {order, {4, 2, 2}, kSize, kYoungsModulus, kPoissonsRatio});
  // Points of the far end, by their places before the warp.
  const TetMesh straight = make_box(order, {4, 2, 2}, kSize * Vec3(1, 0.6, 0.5));
  Problem problem;
  problem.tools =
      bond_as_one(points_where(straight, [](const Vec3& p) { return p.x() > kSize * (1 - 1e-9); }));
  problem.scene = std::move(block.scene);
  for (int i = 1; i <= steps; ++i) problem.way.emplace_back(t * i / steps);
  return problem;
}

/// A bar of which each point of the far end turns about the bar's axis.
Problem twist_problem(ElementOrder order, Law law, int steps) {
  const Vec3 size = kSize * Vec3(3, 0.6, 0.5);
  const bool quadratic = order == ElementOrder::quadratic;
  TetMesh mesh = make_box(order, {quadratic ? 8 : 14, quadratic ? 1 : 2, quadratic ? 1 : 2}, size);
  const auto end = points_where(mesh, [&](const Vec3& p) { return p.x() > size.x() * (1 - 1e-9); });
  Problem problem;
  problem.tools = bond_nodes(end);
  for (int i = 1; i <= steps; ++i) {
    const double angle = 2 * M_PI * i / steps;
    Eigen::VectorXd t(3 * end.size());
    for (std::size_t k = 0; k < end.size(); ++k) {
      const double y = mesh.points[end[k]].y() - size.y() / 2;
      const double z = mesh.points[end[k]].z() - size.z() / 2;
      t.segment<3>(3 * k) = Vec3(0, (std::cos(angle) - 1) * y - std::sin(angle) * z,
                                 std::sin(angle) * y + (std::cos(angle) - 1) * z);
    }
    // A whole turn is no displacement at all, to the last digit.
    if (i == steps) t.setZero();
    problem.way.push_back(t);
  }
  const std::vector<char> fixed = fixed_where(mesh, at_left);
  problem.scene = make_scene(std::move(mesh), tissue(law), fixed);
  return problem;
}

void add_large_displacements(std::vector<Case>& cases) {
  constexpr int kMany = 10;
  constexpr int kTurns = 24;
  // Of steps in one solve: where the path has many folds it is not followed for long.
  constexpr int kFewSteps = 60;
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    const bool svk = law == Law::st_venant_kirchhoff;
    const bool linear = law == Law::linear;
    for (int steps : {1, kMany}) {
      const std::string in = steps == 1 ? " in one step" : " in ten steps";
      // The linear law knows no rotation and no inversion. Pulled to twice its length, St.
      // Venant–Kirchhoff with ν = 0.35 has no lateral stretch left where it is free: λ² = 1 −
      // ν (2² − 1) < 0. The others stay whole.
      const Expected whole =
          linear ? converges_and_may_invert() : (svk ? converges_somehow() : converges());
      cases.push_back({"Pull to 200 %" + in, body, whole,
                       [=] { return patch_problem(order, law, kSize * Vec3(1, 0, 0), steps); }});
      // Bonded at its ends, the body bulges. St. Venant–Kirchhoff softens as it is compressed: at
      // its edges it is past its loss of stability before the body is shorter by a third.
      cases.push_back(
          {"Push to 60 %" + in, body,
           linear ? converges_and_may_invert() : (svk ? converges_or_stops() : converges_somehow()),
           [=] { return patch_problem(order, law, kSize * Vec3(-0.4, 0, 0), steps); }, 5,
           kFewSteps});
      // Beyond that it wrinkles, in more ways than one; the linear law knows nothing of it.
      cases.push_back({"Push to 20 %" + in, body,
                       linear ? converges_and_may_invert() : converges_or_stops(),
                       [=] { return patch_problem(order, law, kSize * Vec3(-0.8, 0, 0), steps); },
                       5, kFewSteps});
      cases.push_back({"Shear by 100 %" + in, body, whole,
                       [=] { return patch_problem(order, law, kSize * Vec3(0, 1, 0), steps); }});
    }
    // In one step a whole turn is no displacement: the body stays at rest.
    cases.push_back({"Twist by 360° in one step", body, converges(),
                     [=] { return twist_problem(order, law, 1); }});
    // Step by step it is a twisted bar, but for the linear law, which has one equilibrium each. The
    // middle of the bar is compressed, which St. Venant–Kirchhoff bears to a certain amount.
    cases.push_back({"Twist by 360° in 24 steps", body,
                     linear ? converges() : (svk ? converges_or_stops() : converges_somehow()),
                     [=] { return twist_problem(order, law, kTurns); }, 5, kFewSteps});
  });
}

// How it is held -----------------------------------------------------------------------------

void add_supports(std::vector<Case>& cases) {
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    const auto block_held_at = [=](const std::vector<Vec3>& places) {
      Block block = make_block(law, {order});
      auto& fixed = block.scene.body.fixed;
      std::fill(fixed.begin(), fixed.end(), 0);
      for (const Vec3& place : places)
        fixed[nearest_point(block.scene.body.mesh, kSize * place)] = 1;
      return hold_point(std::move(block.scene), block.corner, kSize * Vec3(0.05, 0.02, 0.03));
    };
    cases.push_back({"Not held at all", body, is_refused(), [=] { return block_held_at({}); }});
    cases.push_back(
        {"Held at one point", body, is_not_held(), [=] { return block_held_at({Vec3(0, 0, 0)}); }});
    // With the active node, which is not in line with them, two points hold it.
    cases.push_back({"Held at two points", body, converges(), [=] {
                       return block_held_at({Vec3(0, 0, 0), Vec3(0, 0.6, 0)});
                     }});
    cases.push_back({"Held everywhere", body, is_incompressible(law) ? stops() : converges(), [=] {
                       // All but one point of the surface, which is pulled out: that changes the
                       // volume.
                       Block block = make_block(law, {order});
                       std::fill(block.scene.body.fixed.begin(), block.scene.body.fixed.end(), 1);
                       block.scene.body.fixed[block.middle] = 0;
                       return hold_point(std::move(block.scene), block.middle,
                                         kSize * Vec3(0.02, 0, 0));
                     }});
    const auto two_parts = [=](bool hold_second) {
      Block block = make_block(law, {order, {2, 2, 2}});
      Scene& scene = block.scene;
      const Index first = scene.body.mesh.num_points();
      add_copy(scene.body.mesh, Vec3(3 * kSize, 0, 0));
      scene.body.touchable.resize(2 * first, 1);
      scene.body.fixed.resize(2 * first, 0);
      if (hold_second)
        std::copy_n(scene.body.fixed.begin(), first, scene.body.fixed.begin() + first);
      return hold_point(std::move(scene), block.corner, kSize * Vec3(0.05, 0.02, 0.03));
    };
    cases.push_back(
        {"Two parts, one of them not held", body, is_not_held(), [=] { return two_parts(false); }});
    cases.push_back({"Two parts, both held", body, converges(), [=] { return two_parts(true); }});
  });
}

// Cells --------------------------------------------------------------------------------------

TetMesh one_cell(ElementOrder order) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {kSize, 0, 0}, {0, kSize, 0}, {0, 0, kSize}};
  mesh.cells = {0, 1, 2, 3};
  return order == ElementOrder::linear ? mesh : with_midside_nodes(mesh);
}

void add_cells(std::vector<Case>& cases) {
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    const bool quadratic = order == ElementOrder::quadratic;
    const auto single = [=](const Vec3& t) {
      TetMesh mesh = one_cell(order);
      const auto fixed = fixed_where(mesh, [](const Vec3& p) { return p.z() == 0; });
      return hold_point(make_scene(std::move(mesh), tissue(law), fixed), 3, kSize * t);
    };
    // Of a Tet10 the midside nodes are free, with them the volume may stay. Of a Tet4 the apex is
    // all there is: only along the base it may move without a change of volume.
    cases.push_back({"A single element, sheared", body, converges(),
                     [=] { return single(Vec3(0.1, 0.05, 0)); }});
    cases.push_back(
        {"A single element, stretched", body,
         is_incompressible(law) ? (quadratic ? converges_or_stops() : stops()) : converges(),
         [=] { return single(Vec3(0, 0, 0.2)); }});
    if (!quadratic) {
      // No barrier law can follow, since nothing but the apex can move. The others invert.
      cases.push_back({"A single element, its apex pushed through the base", body,
                       has_inversion_barrier(law) ? stops() : converges_somehow(flags::inverted),
                       [=] { return single(Vec3(0, 0, -1.4)); }});
    }
    cases.push_back({"Cells with corners in left-handed order", body, converges(), [=] {
                       Block block = make_block(law, {order});
                       TetMesh& mesh = block.scene.body.mesh;
                       for (Index c = 0; c < mesh.num_cells(); c += 2) {
                         Index* cell = mesh.cells.data() +
                                       static_cast<std::ptrdiff_t>(c) * nodes_per_cell(order);
                         std::swap(cell[0], cell[1]);
                         if (quadratic) {  // edges 01 12 02 03 13 23
                           std::swap(cell[5], cell[6]);
                           std::swap(cell[7], cell[8]);
                         }
                       }
                       return hold_point(std::move(block.scene), block.corner,
                                         kSize * Vec3(0.05, 0.02, 0.03));
                     }});
    if (quadratic) {
      cases.push_back({"A Tet10 folded by a midside node", body, is_refused(), [=] {
                         TetMesh mesh = one_cell(order);
                         mesh.points[9] =
                             kSize * Vec3(0.1, 0.1, 0.1);  // of the edge 23, drawn into the cell
                         mesh.points[8] = kSize * Vec3(-0.2, 0.1, 0.3);
                         const auto fixed =
                             fixed_where(mesh, [](const Vec3& p) { return p.z() == 0; });
                         return hold_point(make_scene(std::move(mesh), tissue(law), fixed), 3,
                                           Vec3(0, 0, 0.1 * kSize));
                       }});
    }
  });
}

// Loss of stability, tiny displacements, loads that nothing carries ---------------------------

void add_stability(std::vector<Case>& cases) {
  for (ElementOrder order : kOrders) {
    // Held in the middle of its way, a slender column of ν = 0 has the straight state for an
    // equilibrium, and is not stable there, beyond a strain of a few per cent. The force of the
    // straight column falls beyond λ² = 1/3, a strain of 42 %.
    for (double strain : {0.2, 0.5}) {
      cases.push_back(
          {"Column of St. Venant-Kirchhoff compressed by " + number(100 * strain) + " %",
           order_name(order), converges_somehow(), [=] {
             TetMesh mesh = make_box(order, {8, 1, 1}, kSize * Vec3(8, 1, 1));
             const auto fixed = fixed_where(mesh, at_left);
             Problem problem;
             problem.tools = bond_as_one(
                 points_where(mesh, [](const Vec3& p) { return p.x() > kSize * 8 * (1 - 1e-9); }));
             problem.scene =
                 make_scene(std::move(mesh), tissue(Law::st_venant_kirchhoff, 0), fixed);
             problem.way = {Eigen::VectorXd(Vec3(-8 * kSize * strain, 0, 0))};
             return problem;
           }});
    }
    // The middle of a block with bonded ends loses it too, in a way that the mesh chooses.
    cases.push_back({"Block of St. Venant-Kirchhoff compressed by 55 %", order_name(order),
                     converges_or_stops(),
                     [=] {
                       return patch_problem(order, Law::st_venant_kirchhoff,
                                            kSize * Vec3(-0.55, 0, 0), 1);
                     },
                     5, 60});
  }
}

void add_tiny_displacements(std::vector<Case>& cases) {
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    for (double size : {1e-12, 0.0}) {
      cases.push_back({"A displacement of " + number(size) + " m", body, converges(), [=] {
                         Block block = make_block(law, {order});
                         return hold_point(std::move(block.scene), block.corner,
                                           size * Vec3(0.6, 0, 0.8));
                       }});
    }
  });
}

void add_impossible_loads(std::vector<Case>& cases) {
  for_each_body([&](ElementOrder order, Law law, const std::string& body) {
    // All points of the surface are moved as x → λ x: the volume inside is λ times what it was.
    const auto squeezed = [=](double stretch) {
      const int n = order == ElementOrder::quadratic ? 2 : 3;
      TetMesh mesh = make_box(order, {n, n, n}, Vec3::Constant(kSize));
      const std::vector<char> surface = boundary_points(mesh);
      std::vector<char> fixed(mesh.points.size(), 0);
      fixed[0] = 1;
      std::vector<Index> held;
      for (Index p = 1; p < mesh.num_points(); ++p) {
        if (surface[p] != 0) held.push_back(p);
      }
      Eigen::VectorXd t = Eigen::VectorXd::Zero(3 * held.size());
      for (std::size_t i = 0; i < held.size(); ++i) {
        t[3 * i] = (stretch - 1) * mesh.points[held[i]].x();
      }
      Problem problem;
      problem.tools = bond_nodes(held);
      problem.way = {t};
      problem.scene = make_scene(std::move(mesh), tissue(law), fixed);
      return problem;
    };
    cases.push_back({"Closed in and squeezed by 10 %", body,
                     is_incompressible(law) ? stops() : converges(),
                     [=] { return squeezed(0.9); }});
    // Beyond its other side: some cell must invert.
    cases.push_back({"Closed in and turned inside out", body,
                     has_inversion_barrier(law) ? stops() : converges_somehow(flags::inverted),
                     [=] { return squeezed(-0.2); }});
  });
}

}  // namespace

Expected converges(Flags must) { return {{Outcome::converged}, must, 0}; }
Expected converges_and_may_invert() { return {{Outcome::converged}, 0, flags::inverted}; }
Expected converges_somehow(Flags must) { return {{Outcome::converged}, must, kSomehow}; }
Expected converges_or_stops() {
  return {{Outcome::converged, kStops[0], kStops[1], Outcome::budget_used_up}, 0, kSomehow};
}
Expected stops() { return {{kStops[0], kStops[1]}, 0, kSomehow}; }
Expected is_not_held() { return {{Outcome::tangent_not_factorised}, 0, 0}; }
Expected is_refused() { return {}; }

std::string describe(const Expected& expected) {
  const auto& outcomes = expected.outcomes;
  if (outcomes.empty()) return "refused";
  if (outcomes.size() == 1 && outcomes[0] != Outcome::converged) return to_string(outcomes[0]);
  const bool converges = outcomes[0] == Outcome::converged;
  std::string text = converges ? "converged" : "a stop";
  if (converges && outcomes.size() > 1) text += " or a stop";
  if (expected.must != 0) text += ", " + flags_to_string(expected.must);
  const Flags may = expected.may & ~expected.must;
  if (may != 0) text += ", may be " + flags_to_string(may);
  return text;
}

const std::vector<Case>& stability_matrix() {
  static const std::vector<Case> cases = [] {
    std::vector<Case> all;
    add_contrasts(all);
    add_poissons_ratios(all);
    add_slivers(all);
    add_large_displacements(all);
    add_supports(all);
    add_cells(all);
    add_stability(all);
    add_tiny_displacements(all);
    add_impossible_loads(all);
    return all;
  }();
  return cases;
}

std::vector<std::string> groups() {
  std::vector<std::string> names;
  for (const Case& one : stability_matrix()) {
    if (std::find(names.begin(), names.end(), one.group) == names.end()) names.push_back(one.group);
  }
  return names;
}

}  // namespace palpate::test
