#include <gtest/gtest.h>
#include <chrono>
#include "iterative/conjugate_gradients.h"
#include "iterative/lowest_eigenvalue.h"
#include "iterative/smoothed_aggregation.h"
#include "iterative/galerkin.h"
#include "assembly/node_levels.h"
#include "solvers/support/block.h"
#include "solvers/support/box_mesh.h"
namespace palpate::test {
double now(){ return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }
TEST(Smoke, All) {
  for (auto order : {ElementOrder::quadratic, ElementOrder::linear})
  for (int n : {3,6,12,20}) {
    BlockOptions o; o.order=order; o.cells={n,n*2/3,n*2/3};
    Scene scene = make_block(Law::neo_hookean, o).scene;
    Assembly a(scene);
    NodalVector u = NodalVector::Zero(a.state_size()), f; std::vector<double> v;
    a.tangent(u,f,v);
    auto pattern = std::make_shared<const BlockPattern>(make_block_pattern(a.pattern()));
    NodeLevels levels = make_node_levels(scene.mesh, a.unknown_of_point());
    for (auto coarse : {CoarseSolver::aggregation, CoarseSolver::factor}) {
      if (coarse==CoarseSolver::factor && order==ElementOrder::linear && n>12) continue;
    double t0=now();
    auto m = make_preconditioner(pattern, levels, coarse);
    auto rep = m->refresh(v);
    double t1=now();
    Operator k(pattern, v);
    KrylovSolver cg({1e-8,300});
    Eigen::MatrixXd x = Eigen::VectorXd::LinSpaced(a.pattern().size,-1,1);
    auto s = cg.solve(k,*m,x);
    double t2=now();
    Eigen::MatrixXd x3 = Eigen::MatrixXd::Random(a.pattern().size,3);
    auto s3 = cg.solve(k,*m,x3);
    double t3=now();
    auto e = find_lowest_eigenvalue(k,*m);
    double t4=now();
    printf("%d n %d size %d setup %s %.3f  cg %s %d %.2e %.3f | 3: %s %d %.3f | eig %s %g err %g its %d %.3f | B/unknown %.0f\n", (int)order, n, a.pattern().size, to_string(rep).c_str(), t1-t0, to_string(s.status).c_str(), s.iterations, s.residual, t2-t1, to_string(s3.status).c_str(), s3.iterations, t3-t2, to_string(e.status).c_str(), e.value, e.error, e.iterations, t4-t3, double(m->bytes())/a.pattern().size);
    }
  }
}
}
