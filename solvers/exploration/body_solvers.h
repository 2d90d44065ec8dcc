// SPDX-License-Identifier: BSD-3-Clause
// The solvers of the bodies of a run. A solver is made when it is first needed. Where a run has
// many bodies, as an organ of many regions has, only those that were used last are kept, because
// each of them takes the memory of several factors.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <vector>

#include "exploration/state_solver.h"

namespace palpate {

class BodySolvers final : public StateSolver {
 public:
  using Make = std::function<std::unique_ptr<EquilibriumSolver>(const SpaceBody&)>;

  /// @param bodies In the order of their numbers. Their rest has to be known before a tool of them
  ///   is asked for. They must outlive this object.
  /// @param most_kept The number of solvers that are kept, at least 1.
  BodySolvers(const std::vector<SpaceBody>& bodies, Make make, bool with_mesh_errors,
              std::size_t most_kept)
      : bodies_(bodies),
        make_(std::move(make)),
        with_mesh_errors_(with_mesh_errors),
        most_kept_(most_kept) {}

  /// The solver of a body. It is valid until that of another body is asked for.
  [[nodiscard]] EquilibriumSolver& equilibria(BodyId body) { return *solver_of(body).equilibria; }
  /// The tools of a body, which are kept for all bodies.
  [[nodiscard]] InteractionFactory& tools(BodyId body);
  /// What all solvers have done so far, those that are no longer kept too.
  [[nodiscard]] Work work() const;

  [[nodiscard]] Equilibrium begin(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  Tangent tangent) override {
    return states(setup.body).begin(setup, t, tangent);
  }
  [[nodiscard]] Equilibrium solve(const ToolSpaceSetup& setup, const Eigen::VectorXd& t,
                                  const Equilibrium& start, Tangent tangent) override {
    return states(setup.body).solve(setup, t, start, tangent);
  }
  [[nodiscard]] Equilibrium restore(const ToolSpaceSetup& setup, const Equilibrium& near,
                                    Keep kept) override {
    return states(setup.body).restore(setup, near, kept);
  }
  [[nodiscard]] MeshError mesh_error(const ToolSpaceSetup& setup,
                                     const Equilibrium& state) override {
    return states(setup.body).mesh_error(setup, state);
  }
  void forget(const ToolSpaceSetup& setup, const Equilibrium& state) override;

 private:
  struct Solver {
    BodyId body = kFirstBody;
    std::unique_ptr<EquilibriumSolver> equilibria;
    /// It is made when a state is first asked for.
    std::unique_ptr<InteractionSolver> states;
  };

  [[nodiscard]] const SpaceBody& body(BodyId number) const { return find_body(bodies_, number); }
  [[nodiscard]] Solver& solver_of(BodyId number);
  [[nodiscard]] static Work work_of(const Solver& solver);
  [[nodiscard]] InteractionSolver& states(BodyId number);

  const std::vector<SpaceBody>& bodies_;
  Make make_;
  bool with_mesh_errors_;
  std::size_t most_kept_;
  std::map<BodyId, std::unique_ptr<InteractionFactory>> tools_;
  /// The one that was used last is the first.
  std::list<Solver> kept_;
  Work earlier_;
};

}  // namespace palpate
